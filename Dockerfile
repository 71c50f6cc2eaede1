# Two images: `docker build --target ci .` makes one that runs .ci/run and has everything it needs. The default one has
# only the program, as .ci/release makes it.
FROM rust:1-bookworm AS ci
# Packages that .ci/run would install are installed here, so that they are kept between runs.
# hadolint ignore=DL3008
RUN apt-get update && apt-get install -y --no-install-recommends \
      binutils chromium cmake git g++ libeigen3-dev libopencv-core-dev make pkg-config python3-pip python3-venv \
      util-linux valgrind \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /belvedere
COPY . .
RUN rustup show active-toolchain || rustup toolchain install
CMD [".ci/run"]

FROM ci AS build
# As in .ci/release: one static file. It is not tested in an empty root here, because a build lacks the rights for that.
ENV RUSTFLAGS="-C target-feature=+crt-static"
RUN cargo build --release --locked --package belvedere --bin belvedere --target x86_64-unknown-linux-gnu \
    && strip target/x86_64-unknown-linux-gnu/release/belvedere

FROM scratch
COPY --from=build /belvedere/target/x86_64-unknown-linux-gnu/release/belvedere /bin/belvedere
COPY --from=build /belvedere/LICENSE-MIT /belvedere/LICENSE-APACHE /
COPY --from=build --chmod=1777 /var/lib/apt/lists /tmp
ENTRYPOINT ["/bin/belvedere"]
