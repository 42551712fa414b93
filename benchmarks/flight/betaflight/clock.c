// The time of a program becomes that of a simulated world: loaded before it (LD_PRELOAD), for Betaflight's SITL.
//
// Its main loop sleeps 50 us at a time. Here that sleep lets its clock pass, up to a limit; at the limit it waits, and
// says so. A packet with the state of the vehicle moves the limit by one step, after it has been read. So the program
// computes as fast as it can and never sees how long the world takes. What it says (5 bytes, to BETAFLIGHT_REPORT): M,
// the main loop has come to the limit; B, so many bytes of serial ports were read; R, so many packets of sticks. Its
// fixed ports are moved by BETAFLIGHT_PORTS.
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

enum { STATE_BYTES = 144, STICK_BYTES = 40, READ_NS = 1000 };

static _Atomic int64_t now_ns = 1000000000;
static int64_t limit_ns = 1000000000, reported_ns = -1, step_ns = 1000000;
static int report_fd = -1, ports = 0;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t moved = PTHREAD_COND_INITIALIZER;
static __thread uint32_t states, sticks, bytes;

__attribute__((constructor)) static void begin(void)
{
    const char *fd = getenv("BETAFLIGHT_REPORT"), *offset = getenv("BETAFLIGHT_PORTS"), *step = getenv("BETAFLIGHT_STEP");
    report_fd = fd ? atoi(fd) : -1;
    ports = offset ? atoi(offset) : 0;
    step_ns = step ? atoll(step) : step_ns;
}

static void *next(const char *name) { return dlsym(RTLD_NEXT, name); }

static int is_main(void)
{
    static __thread int known = -1;
    if (known < 0)
        known = getpid() == (pid_t)syscall(SYS_gettid);
    return known;
}

static void report(char kind, uint32_t count)
{
    unsigned char message[5] = {(unsigned char)kind};
    memcpy(message + 1, &count, 4);
    if (report_fd >= 0 && write(report_fd, message, 5) != 5)
        _exit(1); // the world is gone
}

int clock_gettime(clockid_t id, struct timespec *time)
{
    static int (*real)(clockid_t, struct timespec *);
    if (id != CLOCK_MONOTONIC) {
        if (!real)
            real = next("clock_gettime");
        return real(id, time);
    }
    // A loop that polls the clock must come to an end.
    int64_t now = is_main() ? atomic_fetch_add(&now_ns, READ_NS) + READ_NS : atomic_load(&now_ns);
    time->tv_sec = now / 1000000000;
    time->tv_nsec = now % 1000000000;
    return 0;
}

int nanosleep(const struct timespec *wanted, struct timespec *left)
{
    static int (*real)(const struct timespec *, struct timespec *);
    if (!is_main()) {
        if (!real)
            real = next("nanosleep");
        return real(wanted, left);
    }
    int64_t end = atomic_load(&now_ns) + wanted->tv_sec * 1000000000LL + wanted->tv_nsec;
    pthread_mutex_lock(&lock);
    while (atomic_load(&now_ns) < end) {
        if (atomic_load(&now_ns) >= limit_ns) {
            if (reported_ns != limit_ns) {
                reported_ns = limit_ns;
                report('M', 0);
            }
            pthread_cond_wait(&moved, &lock);
        } else {
            atomic_store(&now_ns, end < limit_ns ? end : limit_ns);
        }
    }
    pthread_mutex_unlock(&lock);
    return 0;
}

ssize_t recvfrom(int fd, void *data, size_t size, int flags, struct sockaddr *from, socklen_t *length)
{
    static ssize_t (*real)(int, void *, size_t, int, struct sockaddr *, socklen_t *);
    if (!real)
        real = next("recvfrom");
    ssize_t count = real(fd, data, size, flags, from, length);
    states += count == STATE_BYTES;
    sticks += count == STICK_BYTES;
    return count;
}

ssize_t recv(int fd, void *data, size_t size, int flags)
{
    static ssize_t (*real)(int, void *, size_t, int);
    if (!real)
        real = next("recv");
    ssize_t count = real(fd, data, size, flags);
    if (count > 0)
        bytes += (uint32_t)count;
    return count;
}

// A thread that waits again has dealt with what it read.
int select(int count, fd_set *reads, fd_set *writes, fd_set *errors, struct timeval *limit)
{
    static int (*real)(int, fd_set *, fd_set *, fd_set *, struct timeval *);
    if (!real)
        real = next("select");
    if (states) {
        pthread_mutex_lock(&lock);
        limit_ns += states * step_ns;
        states = 0;
        pthread_cond_broadcast(&moved);
        pthread_mutex_unlock(&lock);
    }
    if (sticks)
        report('R', sticks);
    if (bytes)
        report('B', bytes);
    sticks = bytes = 0;
    return real(count, reads, writes, errors, limit);
}

static struct sockaddr_storage shifted(const struct sockaddr *address, socklen_t length)
{
    struct sockaddr_storage copy;
    memset(&copy, 0, sizeof copy);
    memcpy(&copy, address, length);
    if (address->sa_family == AF_INET) {
        struct sockaddr_in *there = (struct sockaddr_in *)&copy;
        there->sin_port = htons(ntohs(there->sin_port) + ports);
    } else if (address->sa_family == AF_INET6) {
        struct sockaddr_in6 *there = (struct sockaddr_in6 *)&copy;
        there->sin6_port = htons(ntohs(there->sin6_port) + ports);
    }
    return copy;
}

int bind(int fd, const struct sockaddr *address, socklen_t length)
{
    static int (*real)(int, const struct sockaddr *, socklen_t);
    if (!real)
        real = next("bind");
    struct sockaddr_storage there = shifted(address, length);
    return real(fd, (struct sockaddr *)&there, length);
}

ssize_t sendto(int fd, const void *data, size_t size, int flags, const struct sockaddr *to, socklen_t length)
{
    static ssize_t (*real)(int, const void *, size_t, int, const struct sockaddr *, socklen_t);
    if (!real)
        real = next("sendto");
    if (!to)
        return real(fd, data, size, flags, to, length);
    struct sockaddr_storage there = shifted(to, length);
    return real(fd, data, size, flags, (struct sockaddr *)&there, length);
}
