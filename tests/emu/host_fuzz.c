/* Feeds the firmware bytes that no host would send and looks at every packet: throttle above zero while disarmed is
 * a failure. What "armed" means is decided here once more, from every byte string that could be a frame wherever it
 * begins, so an error of the firmware's parser is not shared.
 *
 * host_fuzz SEED BYTES MODE     mode 0 noise, 1 good frames with anything in them, 2 flights that are damaged
 * Prints: bytes, packets, packets with throttle, good frames that the judge saw, times that it saw arming.
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
    uint8_t last[FRAME];
    unsigned long lows, frames, armings;
    unsigned long since_good; /* ticks since a good frame */
    bool armed;
} judge;

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

static void judge_byte(uint8_t byte)
{
    const uint8_t *f = judge.last;
    memmove(judge.last, judge.last + 1, FRAME - 1);
    judge.last[FRAME - 1] = byte;
    if (f[0] != 0xC8 || f[1] != 24 || f[2] != 0x16 || slow_crc(f + 2, 23) != f[25])
        return;
    for (int i = 0; i < 16; i++)
        if (channel(f + 3, i) < 172 || channel(f + 3, i) > 1811)
            return;
    judge.frames++;
    judge.since_good = 0;
    bool idle = channel(f + 3, 2) <= 175;
    if (channel(f + 3, 4) <= 500) {
        judge.lows += idle;
        judge.armed = false;
    } else if (channel(f + 3, 4) >= 1500) {
        if (!judge.armed && idle && judge.lows >= 3) {
            judge.armed = true;
            judge.armings++;
            judge.lows = 0;
        }
    } else {
        judge.armed = false;
    }
}

/* ---- what is fed ---- */

static uint8_t queue[64];
static unsigned queued, taken;

static void make_frame(bool sane)
{
    static int phase; /* of a flight: disarmed, arming, flying */
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

static uint8_t next_byte(int mode)
{
    if (mode == 0 || (taken == queued && chance(8))) {
        uint32_t kind = random32() % 8;
        static const uint8_t header[3] = {CRSF_SYNC, 24, CRSF_CHANNELS};
        static unsigned in_header;
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

static void look(void)
{
    uint8_t packet[32], size, channel_now, address[5];
    if (!host_packet(packet, &size, &channel_now, address))
        return;
    packets++;
    uint8_t sum = 0;
    for (int i = 0; i < 9; i++)
        sum ^= packet[i];
    if (size != 10 || channel_now > 83 || packet[9] != (uint8_t)(sum + 0x55)) {
        printf("malformed packet %lu\n", packets);
        exit(1);
    }
    bool bind = memcmp(address, "\xAB\xAC\xAD\xAE\xAF", 5) == 0;
    if (bind ? memcmp(packet + 5, "\xAA\xAA\xAA", 3) != 0 : packet[0] != 0) {
        with_throttle += !bind;
        if (bind || !judge.armed || judge.since_good > 61) {
            printf("packet %lu has throttle %u while disarmed\n", packets, packet[0]);
            exit(1);
        }
    }
}

int main(int argc, char **argv)
{
    if (argc != 4)
        return 2;
    state = 0x9E3779B97F4A7C15u ^ strtoull(argv[1], NULL, 10) * 0xD1342543DE82EF95u;
    unsigned long count = strtoul(argv[2], NULL, 10);
    int mode = atoi(argv[3]);
    uint8_t sink[256];
    memset(host_memory, 0xFF, sizeof host_memory);
    host_power_on();
    transmitter_begin(START_OTHER_RESET);
    for (unsigned long i = 0; i < count; i++) {
        uint8_t byte = next_byte(mode);
        judge_byte(byte);
        host_serial_in(&byte, 1);
        while (transmitter_work())
            host_serial_out(sink, sizeof sink);
        if (i % BYTES_PER_TICK == BYTES_PER_TICK / 2)
            transmitter_prepare();
        if (i % BYTES_PER_TICK == BYTES_PER_TICK - 1) {
            judge.since_good++;
            transmitter_tick();
            look();
            /* Rarely the host is gone for longer than the failsafe takes. */
            for (uint32_t idle = chance(2000) ? 20 + random32() % 100 : 0; idle; idle--) {
                judge.since_good++;
                transmitter_prepare();
                transmitter_tick();
                look();
            }
            if (judge.since_good > 61)
                judge.armed = false, judge.lows = 0;
        }
    }
    printf("%lu %lu %lu %lu %lu\n", count, packets, with_throttle, judge.frames, judge.armings);
    return 0;
}
