# matchset with all kernels compiled ahead. Build: docker build -t matchset .
# Run, with your videos in the folder of now, nothing else writable:
#   docker run --rm --read-only --tmpfs /tmp -v "$PWD:/data" -u "$(id -u):$(id -g)" matchset track ball.mp4 --pick 346,151
FROM python:3.12-slim-bookworm AS build
WORKDIR /source
COPY pyproject.toml README.md LICENSE ./
COPY src ./src
RUN python -m venv /opt/matchset && \
    /opt/matchset/bin/pip install --no-cache-dir --no-compile .

# Compiled code is kept for the kind of processor that it was made for; on another kind it is compiled again in memory.
FROM python:3.12-slim-bookworm
COPY --from=build /opt/matchset /opt/matchset
ENV PATH=/opt/matchset/bin:$PATH \
    NUMBA_CACHE_DIR=/opt/kernels \
    MPLCONFIGDIR=/tmp/matplotlib \
    HOME=/tmp
RUN useradd --create-home --uid 1000 matchset && \
    python -m compileall -q /opt/matchset/lib && \
    matchset warm && \
    chown -R 1000:1000 /opt/kernels && \
    chmod -R a+rX /opt/kernels
USER 1000:1000
WORKDIR /data
ENTRYPOINT ["matchset"]
CMD ["--help"]
