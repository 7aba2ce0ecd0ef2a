// Writes the files of this folder, by OpenVDB itself:
//   g++ -O1 make.cc -lopenvdb -ltbb -lImath -ldl -o make && ./make      (Debian: libopenvdb-dev)
// The values are those of the formulas in ../vdb.rs.
#include <dlfcn.h>
#include <openvdb/openvdb.h>

#include <cstdlib>

using namespace openvdb;

// Size of the blocks that blosc compresses apart, in place of that which OpenVDB chooses.
static size_t block = 0;

extern "C" int blosc_compress_ctx(int level, int shuffle, size_t type, size_t count, const void* source, void* target, size_t room,
                                  const char* codec, size_t usual, int threads) {
    static auto compress = reinterpret_cast<decltype(&blosc_compress_ctx)>(dlsym(RTLD_NEXT, "blosc_compress_ctx"));
    return compress(level, shuffle, type, count, source, target, room, codec, block ? block : usual, threads);
}

// Densities with gaps, on both sides of x = 0, where the root has two nodes; and a tile of 8³ voxels.
template <typename GridT>
typename GridT::Ptr smoke() {
    auto grid = GridT::create(0);
    auto voxels = grid->getAccessor();
    for (int i = -3; i <= 6; i++)
        for (int j = 0; j <= 5; j++)
            for (int k = 0; k <= 9; k++)
                if ((i + j + k + 3) % 3 != 0) voxels.setValue({i, j, k}, typename GridT::ValueType((1 + std::abs(i) + 2 * j + 3 * k) / 64.0));
    grid->tree().addTile(1, Coord(8, 8, 8), typename GridT::ValueType(0.75), true);
    grid->setGridClass(GRID_FOG_VOLUME);
    grid->setName("density");
    return grid;
}

math::Transform::Ptr placed(double scale) {
    auto transform = math::Transform::createLinearTransform(scale);
    transform->postTranslate({0.5, 1.5, -2});
    return transform;
}

// Inactive voxels of all kinds that a background of 0 leaves, one leaf for each.
FloatGrid::Ptr inactive() {
    auto grid = FloatGrid::create(0);
    auto voxels = grid->getAccessor();
    for (int leaf = 0; leaf < 5; leaf++)
        for (int i = 0; i < 8; i++)
            for (int j = 0; j < 8; j++)
                for (int k = 0; k < 8; k++) {
                    const Coord at(8 * leaf + i, j, k);
                    const float values[] = {0, 0.5f, k % 2 ? 0.5f : 0, k % 2 ? 0.25f : 0.5f, (i + 8 * j + 64 * k) / 512.0f};
                    if (i == j) voxels.setValue(at, 1 + leaf);
                    else voxels.setValueOff(at, values[leaf]);
                }
    grid->setName("inactive");
    return grid;
}

template <typename GridT>
typename GridT::Ptr named(const char* name, typename GridT::ValueType background, bool has_voxel = true) {
    auto grid = GridT::create(background);
    if (has_voxel) grid->getAccessor().setValue({1, 2, 3}, typename GridT::ValueType(1));
    grid->setName(name);
    return grid;
}

void write(const char* name, GridPtrVec grids, uint32_t compression) {
    io::File file(name);
    file.setCompression(compression);
    file.write(grids);
}

int main() {
    initialize();
    const uint32_t blosc = io::COMPRESS_BLOSC | io::COMPRESS_ACTIVE_MASK;

    auto density = smoke<FloatGrid>();
    density->setTransform(placed(0.25));
    // A colour in fewer voxels, and a second grid with the same tree elsewhere.
    auto flame = Vec3SGrid::create(Vec3s(0));
    flame->setTransform(placed(0.25));
    for (int i = 0; i <= 2; i++)
        for (int j = 0; j <= 2; j++)
            for (int k = 0; k <= 2; k++) flame->getAccessor().setValue({i, j, k}, Vec3s(i, 2 * j, 3 * k) / 8.0f);
    flame->setName("flame");
    auto copy = FloatGrid::create();
    copy->setTree(density->treePtr());
    copy->setTransform(math::Transform::createLinearTransform(0.5));
    copy->setName("copy");
    write("blosc.vdb", {density, flame, copy}, blosc);
    write("zip.vdb", {density}, io::COMPRESS_ZIP | io::COMPRESS_ACTIVE_MASK);
    write("mask.vdb", {density}, io::COMPRESS_ACTIVE_MASK);
    // Nodes with all their values, which blosc makes small.
    write("full.vdb", {density}, io::COMPRESS_BLOSC);

    auto half = smoke<FloatGrid>();
    half->setSaveFloatAsHalf(true);
    auto half_flame = flame->deepCopy();
    half_flame->setSaveFloatAsHalf(true);
    auto half_inactive = inactive();
    half_inactive->setSaveFloatAsHalf(true);
    write("half.vdb", {half, half_flame, half_inactive}, blosc);

    // Runs of several blocks, whose last one is shorter.
    block = 600;
    write("blocks.vdb", {density}, io::COMPRESS_BLOSC);
    block = 0;

    auto wide = smoke<DoubleGrid>();
    auto stretched = math::Transform::createLinearTransform(1);
    stretched->preScale({0.5, 1, 2});
    wide->setTransform(stretched);
    auto block = FloatGrid::create(0);
    block->tree().addTile(2, Coord(0, 0, 0), 0.5f, true);
    block->setName("block");
    write("more.vdb", {wide, inactive(), block}, blosc);

    // A small one, which the fuzz tests damage.
    write("../fuzz/seeds/volume/few.vdb", {named<FloatGrid>("density", 0)}, blosc);

    // Values that are not active, beside the only voxel that is.
    auto loose = named<FloatGrid>("loose", 0, false);
    loose->getAccessor().setValue({0, 0, 0}, 1);
    loose->getAccessor().setValueOff({5, 0, 0}, 3);
    loose->tree().addTile(1, Coord(8, 0, 0), 2, false);
    auto distance = named<FloatGrid>("distance", 3);
    distance->setGridClass(GRID_LEVEL_SET);
    auto turned = named<FloatGrid>("turned", 0);
    turned->transform().preRotate(1, math::Z_AXIS);
    auto apart = [](const char* name, int distance) {
        auto grid = named<FloatGrid>(name, 0, false);
        grid->getAccessor().setValue(Coord(0), 1);
        grid->getAccessor().setValue(Coord(distance), 1);
        return grid;
    };
    write("odd.vdb", {distance, named<FloatGrid>("haze", 0.5f), named<FloatGrid>("empty", 0, false), turned, named<Int32Grid>("count", 0), named<Vec3SGrid>("velocity", Vec3s(0)), apart("sparse", 1000), apart("far", 100000), apart("beyond", 1 << 30), loose, named<FloatGrid>("twin", 0), named<FloatGrid>("twin", 0)}, blosc);
}
