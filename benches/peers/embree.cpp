// Rays of files against a mesh of files with Embree 3, one ray at a time, as `rays.rs` measures them with pt.
//
// Arguments: fast, robust or high (robust, with the build of the highest quality); vertices (f32); triangles (u32); then files of rays
// (f32: origin, 0, direction, end), with `:any` after the name if any hit will do. Prints the CPU seconds of the build and its bytes for
// each triangle beside the mesh, then for each file the millions of rays per CPU second, best of three repetitions, and the share of
// rays that hit.

#include <embree3/rtcore.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

template <class T>
static std::vector<T> load(const std::string& path) {
    FILE* file = fopen(path.c_str(), "rb");
    if (!file) {
        perror(path.c_str());
        exit(1);
    }
    fseek(file, 0, SEEK_END);
    std::vector<T> values(ftell(file) / sizeof(T));
    rewind(file);
    if (fread(values.data(), sizeof(T), values.size(), file) != values.size()) exit(1);
    fclose(file);
    return values;
}

static double cpu_seconds() {
    timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return time.tv_sec + 1e-9 * time.tv_nsec;
}

static ssize_t used = 0;

int main(int count, char** arguments) {
    std::string mode = arguments[1];
    auto vertices = load<float>(arguments[2]);
    auto triangles = load<unsigned>(arguments[3]);
    RTCDevice device = rtcNewDevice("threads=1");
    if (!device) {
        fprintf(stderr, "Embree: no device, error %d\n", rtcGetDeviceError(nullptr));
        return 1;
    }
    rtcSetDeviceMemoryMonitorFunction(device, [](void*, ssize_t bytes, bool) { used += bytes; return true; }, nullptr);
    RTCScene scene = rtcNewScene(device);
    if (mode != "fast") rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    if (mode == "high") rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = (float*)rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, vertices.size() / 3);
    std::copy(vertices.begin(), vertices.end(), v);
    auto* t = (unsigned*)rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, triangles.size() / 3);
    std::copy(triangles.begin(), triangles.end(), t);
    ssize_t of_mesh = used;
    double start = cpu_seconds();
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene, mesh);
    rtcCommitScene(scene);
    printf("%.3f %.0f\n", cpu_seconds() - start, 3.0 * (used - of_mesh) / triangles.size());
    for (int k = 4; k < count; k++) {
        std::string name = arguments[k];
        bool any = name.size() > 4 && name.substr(name.size() - 4) == ":any";
        auto rays = load<float>(any ? name.substr(0, name.size() - 4) : name);
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        double best = INFINITY;
        size_t hits = 0;
        for (int repetition = 0; repetition < 3; repetition++) {
            hits = 0;
            start = cpu_seconds();
            for (size_t i = 0; i + 8 <= rays.size(); i += 8) {
                const float* r = &rays[i];
                RTCRayHit query;
                query.ray = {r[0], r[1], r[2], 0, r[4], r[5], r[6], 0, r[7], ~0u, 0, 0};
                query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
                query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
                if (any) {
                    rtcOccluded1(scene, &context, &query.ray);
                    hits += query.ray.tfar < 0;
                } else {
                    rtcIntersect1(scene, &context, &query);
                    hits += query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
                }
            }
            best = std::min(best, cpu_seconds() - start);
        }
        double number = rays.size() / 8.0;
        printf("%.3f %.6f\n", 1e-6 * number / best, hits / number);
    }
}
