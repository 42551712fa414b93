/* Feeds the firmware bytes that no host would send and looks at every packet: throttle above zero while disarmed is
 * a failure. Which frames there are, what "armed" means, and how fast the throttle may rise is decided here once more,
 * from the rules and not from the firmware's code, so an error of the firmware is not shared.
 *
 * host_fuzz SEED[-LAST] BYTES MODE     mode 0 noise, 1 good frames with anything in them, 2 flights that are damaged,
 *                                      3 each of them; BYTES is for each seed and mode
 * Prints: bytes, packets, packets with throttle, good frames that the judge saw, times that it saw arming; the sums of
 * all seeds. The first failure ends it with one line that says seed and mode, and exit code 1.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "config.h"
#include "crc8.h"
#include "crsf.h"
#include "host_board.h"
#include "transmitter.h"

#define BYTES_PER_TICK 46 /* 115200 baud */
#define FRAME 26

static uint64_t state;

static uint32_t random32(void)
{
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (uint32_t)(state >> 16);
}

static bool chance(uint32_t one_in)
{
    return random32() % one_in == 0;
}

/* ---- the judge ---- */

static struct {
    uint8_t stream[64]; /* bytes that are in no frame yet */
    int waiting;
    int lows;                 /* frames in a row that prepare arming */
    unsigned long since_good; /* ticks since a good frame */
    bool armed;
    unsigned flown, one, two; /* the highest throttle that may be flown, and those of the last two frames */
} judge;

static unsigned long frames, armings;

static unsigned channel(const uint8_t *payload, int which)
{
    unsigned value = 0;
    for (int bit = 0; bit < 11; bit++) {
        int place = which * 11 + bit;
        value |= (unsigned)(payload[place / 8] >> (place % 8) & 1) << bit;
    }
    return value;
}

static uint8_t slow_crc(const uint8_t *bytes, int count)
{
    uint8_t crc = 0;
    while (count--) {
        crc ^= *bytes++;
        for (int bit = 0; bit < 8; bit++)
            crc = (uint8_t)(crc & 0x80 ? crc << 1 ^ 0xD5 : crc << 1);
    }
    return crc;
}

/* Whether the bytes that wait begin with a frame: its size, 0 if they do not, -1 if more of them must come first. */
static int frame_size(const uint8_t *f, int count)
{
    static const struct { uint8_t type, size; const char *begin; } known[] = {
        {0x16, 26, ""}, {0xE2, 4, ""}, {0xE3, 21, "SET"}, {0xE4, 8, "BIND"},
    };
    if (f[0] != 0xC8)
        return 0;
    if (count < 3)
        return -1;
    for (unsigned i = 0; i < sizeof known / sizeof *known; i++) {
        int size = known[i].size;
        if (f[2] != known[i].type || f[1] != size - 2)
            continue;
        if (count < size)
            return -1;
        if (slow_crc(f + 2, size - 3) != f[size - 1] || memcmp(f + 3, known[i].begin, strlen(known[i].begin)) != 0)
            return 0;
        for (int which = 0; f[2] == 0x16 && which < 16; which++)
            if (channel(f + 3, which) < 172 || channel(f + 3, which) > 1811)
                return 0;
        return size;
    }
    return 0;
}

static void judge_channels(const uint8_t *payload)
{
    unsigned arm = channel(payload, 4);
    bool idle = channel(payload, 2) <= 175;
    /* One frame alone raises the throttle by 38 of 255 for each 40 ms since the last; 1 more for rounding. */
    unsigned said = ((channel(payload, 2) - 172) * 510 + 1639) / 3278 + 1;
    unsigned most = judge.one > judge.two ? judge.one : judge.two;
    most = (most > judge.flown ? most : judge.flown) + 38 * (1 + (unsigned)judge.since_good / 10);
    judge.flown = said < most ? said : most;
    judge.two = judge.one;
    judge.one = said;
    frames++;
    judge.since_good = 0;
    if (arm <= 500) {
        judge.lows = idle ? judge.lows + 1 : 0;
        judge.armed = false;
        return;
    }
    if (arm < 1500) {
        judge.armed = false;
    } else if (!judge.armed && idle && judge.lows >= 3) {
        judge.armed = true;
        judge.flown = 0;
        armings++;
    }
    judge.lows = 0;
}

static void judge_byte(uint8_t byte)
{
    judge.stream[judge.waiting++] = byte;
    while (judge.waiting) {
        int size = frame_size(judge.stream, judge.waiting);
        if (size < 0)
            return;
        if (size == FRAME)
            judge_channels(judge.stream + 3);
        judge.waiting -= size ? size : 1;
        memmove(judge.stream, judge.stream + (size ? size : 1), (size_t)judge.waiting);
    }
}

static void judge_tick(void)
{
    if (++judge.since_good >= 61)
        judge.armed = false, judge.lows = 0;
}

/* ---- what is fed ---- */

static unsigned long seed;
static int mode;

static uint8_t queue[64];
static unsigned queued, taken, in_header;
static int phase; /* of a flight: disarmed, arming, flying */

static void make_frame(bool sane)
{
    uint8_t *f = queue;
    uint16_t values[16];
    for (int i = 0; i < 16; i++)
        values[i] = (uint16_t)(sane ? 172 + random32() % 1640 : random32() % 2048);
    if (chance(40))
        phase = (int)(random32() % 3);
    values[4] = phase ? 1811 : 172;
    if (phase < 2 && sane)
        values[2] = 172;
    uint32_t pool = 0;
    int bits = 0, place = 3;
    for (int i = 0; i < 16; i++) {
        pool |= (uint32_t)values[i] << bits;
        for (bits += 11; bits >= 8; bits -= 8, pool >>= 8)
            f[place++] = (uint8_t)pool;
    }
    f[0] = CRSF_SYNC, f[1] = 24, f[2] = CRSF_CHANNELS;
    f[25] = slow_crc(f + 2, 23);
    queued = FRAME, taken = 0;
}

static void make_other(void)
{
    static const uint8_t types[] = {CRSF_READ_CONFIG, CRSF_WRITE_CONFIG, CRSF_BIND, CRSF_CHANNELS};
    static const uint8_t sizes[] = {0, 3 + CONFIG_SIZE, 4, 22};
    int which = (int)(random32() % 4);
    for (int i = 0; i < sizes[which]; i++)
        queue[3 + i] = (uint8_t)random32();
    if (which == 1 && !chance(4))
        memcpy(queue + 3, "SET\1", 4);
    if (which == 2 && chance(60))
        memcpy(queue + 3, "BIND", 4);
    queued = crsf_frame(queue, types[which], sizes[which]), taken = 0;
}

static uint8_t next_byte(void)
{
    if (mode == 0 || (taken == queued && chance(8))) {
        uint32_t kind = random32() % 8;
        static const uint8_t header[3] = {CRSF_SYNC, 24, CRSF_CHANNELS};
        if (in_header % 3 || chance(60))
            return header[in_header++ % 3];
        return kind == 0 ? CRSF_SYNC : (uint8_t)random32();
    }
    if (taken == queued) {
        if (mode == 1 && chance(3))
            make_other();
        else
            make_frame(mode == 2 || chance(2));
    }
    uint8_t byte = queue[taken++];
    if (mode == 2 && chance(100))
        byte ^= (uint8_t)(1u << random32() % 8);
    if (mode == 2 && chance(200) && taken < queued)
        taken++;
    return byte;
}

static unsigned long packets, with_throttle;

static void fail(const char *what, uint8_t throttle)
{
    printf("seed %lu, mode %d, packet %lu: %s, throttle %u\n", seed, mode, packets, what, throttle);
    exit(1);
}

static void look(void)
{
    uint8_t packet[32], size, channel_now, address[5];
    if (!host_packet(packet, &size, &channel_now, address))
        return;
    packets++;
    uint8_t sum = 0;
    for (int i = 0; i < 9; i++)
        sum ^= packet[i];
    if (size != 10 || channel_now > 83 || packet[9] != (uint8_t)(sum + 0x55))
        fail("malformed", packet[0]);
    if (memcmp(address, "\xAB\xAC\xAD\xAE\xAF", 5) == 0) {
        if (memcmp(packet + 5, "\xAA\xAA\xAA", 3) != 0)
            fail("malformed bind packet", packet[0]);
    } else if (packet[0] != 0) {
        with_throttle++;
        if (!judge.armed)
            fail("throttle while disarmed", packet[0]);
        if (packet[0] > judge.flown)
            fail("more throttle than two frames said", packet[0]);
    }
}

static void tick(void)
{
    judge_tick();
    transmitter_tick();
    look();
}

static void start(enum start why)
{
    memset(&judge, 0, sizeof judge);
    judge.since_good = 61;
    host_power_on();
    transmitter_begin(why);
}

static void run(unsigned long count)
{
    uint8_t sink[256];
    state = 0x9E3779B97F4A7C15u ^ seed * 0xD1342543DE82EF95u;
    queued = taken = in_header = 0, phase = 0;
    memset(host_memory, 0xFF, sizeof host_memory);
    start(START_OTHER_RESET);
    for (unsigned long i = 0; i < count; i++) {
        uint8_t byte = next_byte();
        judge_byte(byte);
        host_serial_in(&byte, 1);
        while (transmitter_work())
            host_serial_out(sink, sizeof sink);
        if (i % BYTES_PER_TICK == BYTES_PER_TICK / 2)
            transmitter_prepare();
        if (i % BYTES_PER_TICK != BYTES_PER_TICK - 1)
            continue;
        tick();
        /* Rarely the host is gone for longer than the failsafe takes, and more rarely the board restarts. */
        for (uint32_t idle = chance(2000) ? 20 + random32() % 100 : 0; idle; idle--) {
            transmitter_prepare();
            tick();
        }
        if (chance(20000))
            start((enum start)(random32() % 3));
    }
}

int main(int argc, char **argv)
{
    if (argc != 4)
        return 2;
    char *dash;
    unsigned long first = strtoul(argv[1], &dash, 10), count = strtoul(argv[2], NULL, 10), fed = 0;
    unsigned long last = *dash == '-' ? strtoul(dash + 1, NULL, 10) : first;
    int chosen = atoi(argv[3]);
    for (seed = first; seed <= last; seed++)
        for (mode = chosen < 3 ? chosen : 0; mode <= (chosen < 3 ? chosen : 2); mode++, fed += count)
            run(count);
    printf("%lu %lu %lu %lu %lu\n", fed, packets, with_throttle, frames, armings);
    return 0;
}
