# syntax=docker/dockerfile:1
# The binary with every role; .cargo/config.toml gives it the x86-64-v3 flags that the kernels need.
FROM rust:1.95-bookworm AS build
WORKDIR /source
COPY . .
RUN --mount=type=cache,target=/usr/local/cargo/registry --mount=type=cache,target=/source/target \
    cargo build --locked --release -p drillsweep && cp target/release/drillsweep /usr/local/bin/

FROM debian:bookworm-slim
RUN useradd --system --uid 10001 --no-create-home drillsweep && install --directory --mode=700 --owner=drillsweep /data
COPY --from=build /usr/local/bin/drillsweep /usr/local/bin/drillsweep
# Whom an object store's certificate may be from.
COPY --from=build /etc/ssl/certs/ca-certificates.crt /etc/ssl/certs/ca-certificates.crt
USER 10001
ENV DRILLSWEEP_DATA=/data
VOLUME /data
EXPOSE 7340
ENTRYPOINT ["drillsweep"]
CMD ["up"]
