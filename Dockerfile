# The program in an image with nothing else: docker build -t pt . && docker run --rm -v "$PWD:/work" pt scenes/cornell-box.json
FROM rust:1-slim-bookworm AS build
WORKDIR /pt
COPY . .
RUN host=$(rustc -vV | sed -n 's/^host: //p') \
    && RUSTFLAGS="-C target-feature=+crt-static" cargo build --release --locked --target "$host" \
    && mv "target/$host/release/pt" /pt/pt

FROM scratch
COPY --from=build /pt/pt /pt
WORKDIR /work
ENTRYPOINT ["/pt"]
