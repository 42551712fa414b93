/* Feeds the firmware bytes that no host would send and looks at every packet: throttle above zero while disarmed, or more
 * than two frames said, is a failure. host_judge.c decides.
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
#include "host_judge.h"
#include "transmitter.h"

#define BYTES_PER_TICK 46 /* 115200 baud */

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
    f[25] = judge_crc(f + 2, 23);
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

static void look(void)
{
    uint8_t packet[32], size, channel, address[5];
    if (!host_packet(packet, &size, &channel, address))
        return;
    packets++;
    with_throttle += packet[0] && memcmp(packet + 5, "\xAA\xAA\xAA", 3) != 0;
    const char *wrong = judge_packet(packet, size, channel, address);
    if (wrong) {
        printf("seed %lu, mode %d, packet %lu: %s, throttle %u\n", seed, mode, packets, wrong, packet[0]);
        exit(1);
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
    judge_begin();
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
    printf("%lu %lu %lu %lu %lu\n", fed, packets, with_throttle, judge_frames, judge_armings);
    return 0;
}
