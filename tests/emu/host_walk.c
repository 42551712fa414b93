/* Plays every sequence of so many events to the whole firmware, bytes in and packets and status frames out, and compares
 * both with what the rules say: no throttle while disarmed, no arming but by three frames low and one high, silence ends
 * in motors off, and the status names the state that the rules give, so that a refusal is noticed.
 *
 * host_walk LENGTH     Prints: sequences, packets, status frames. The first failure ends it with one line.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "board.h"
#include "host_board.h"
#include "host_judge.h"
#include "transmitter.h"

enum { BINDING, LOCKED, ARMED, HOLDING, FAILSAFE };
enum event {
    LOW_ZERO, LOW_FULL, MIDDLE_FULL, HIGH_ZERO, HIGH_FULL, DAMAGED, OUT_OF_RANGE, PAUSE, SILENCE, BIND, RESET, EVENTS
};
static const char *const names[EVENTS] = {
    "low zero", "low full", "middle full", "high zero", "high full", "damaged", "out of range", "pause", "silence", "bind",
    "reset",
};
#define FRAME_TICKS 8 /* 33 ms */
#define LONGEST 5 /* longer ones could see the end of binding, which the rules here leave out */

static unsigned long packets, statuses;
static enum event sequence[LONGEST];
static int length, state, prefix;
static bool binding, failsafe;

static void fail(const char *what)
{
    printf("%s, state by the rules %d, reported %d; prefix %d:", what, binding ? BINDING : judge.armed, state, prefix);
    for (int i = 0; i < length; i++)
        printf(" %s,", names[sequence[i]]);
    printf("\n");
    exit(1);
}

/* Status frames come whole; the fourth byte of their payload is the state. */
static void listen(void)
{
    uint8_t said[256];
    uint32_t count = host_serial_out(said, sizeof said);
    for (uint32_t i = 0; i + 23 <= count; i += said[i + 1] + 2u)
        if (said[i + 2] == 0xE0) {
            state = said[i + 6];
            statuses++;
        }
}

static void work(void)
{
    while (transmitter_work())
        listen();
    listen();
}

static void tick(void)
{
    uint8_t packet[32], size, channel, address[5];
    bool was_armed = judge.armed;
    judge_tick();
    failsafe = failsafe || (was_armed && !judge.armed);
    transmitter_prepare();
    work();
    transmitter_tick();
    if (host_packet(packet, &size, &channel, address)) {
        packets++;
        const char *wrong = judge_packet(packet, size, channel, address);
        if (wrong)
            fail(wrong);
    }
    work();
}

static void send(const uint8_t *bytes, int count)
{
    for (int i = 0; i < count; i++) {
        if (!binding)
            judge_byte(bytes[i]);
        host_serial_in(bytes + i, 1);
        work();
    }
}

static void send_channels(unsigned arm, unsigned throttle, bool damaged)
{
    uint8_t f[FRAME] = {0xC8, 24, 0x16};
    for (int i = 0; i < 16; i++) {
        unsigned value = i == 2 ? throttle : i == 4 ? arm : i == 5 || i == 6 ? 172 : 992;
        for (int bit = 0; bit < 11; bit++)
            f[3 + (i * 11 + bit) / 8] |= (uint8_t)((value >> bit & 1) << (i * 11 + bit) % 8);
    }
    f[25] = (uint8_t)(judge_crc(f + 2, 23) ^ damaged);
    send(f, FRAME);
    if (arm <= 500 && !damaged && throttle <= 1811)
        failsafe = false;
}

static void begin(enum start why)
{
    judge_begin();
    judge.disarms_only = true;
    binding = false;
    failsafe = true;
    host_power_on();
    transmitter_begin(why);
    for (int i = 0; i < FRAME_TICKS; i++)
        tick();
}

static void act(enum event event)
{
    static const uint8_t bind[] = {0xC8, 6, 0xE4, 'B', 'I', 'N', 'D'};
    uint8_t whole[8];
    int ticks = event == PAUSE ? 27 : event == SILENCE ? 62 : FRAME_TICKS;
    switch (event) {
    case LOW_ZERO: send_channels(172, 172, false); break;
    case LOW_FULL: send_channels(172, 1811, false); break;
    case MIDDLE_FULL: send_channels(992, 1811, false); break;
    case HIGH_ZERO: send_channels(1811, 172, false); break;
    case HIGH_FULL: send_channels(1811, 1811, false); break;
    case DAMAGED: send_channels(172, 172, true); break;
    case OUT_OF_RANGE: send_channels(172, 1900, false); break;
    case BIND:
        memcpy(whole, bind, 7);
        whole[7] = judge_crc(whole + 2, 5);
        send(whole, 8);
        if (!judge.armed)
            binding = true, judge.lows = 0;
        break;
    case RESET: begin(START_WATCHDOG); break;
    default: break;
    }
    while (ticks--)
        tick();
    int expected = binding ? BINDING
        : judge.armed ? (judge.since_good >= 26 ? HOLDING : ARMED)
        : failsafe ? FAILSAFE : LOCKED;
    if (state != expected)
        fail("another state is reported");
}

static void play(int before)
{
    static const enum event armed[] = {LOW_ZERO, LOW_ZERO, LOW_ZERO, HIGH_ZERO, HIGH_FULL};
    prefix = before;
    begin(START_OTHER_RESET);
    for (int i = 0; i < before; i++)
        act(armed[i]);
    for (int i = 0; i < length; i++)
        act(sequence[i]);
}

int main(int argc, char **argv)
{
    if (argc != 2 || (length = atoi(argv[1])) < 1 || length > LONGEST)
        return 2;
    memset(host_memory, 0xFF, sizeof host_memory);
    unsigned long sequences = 0;
    for (;;) {
        for (int before = 0; before <= 5; before += before ? 2 : 3, sequences++)
            play(before); /* from a restart, ready to arm, in flight */
        int last = length - 1;
        while (last >= 0 && ++sequence[last] == EVENTS)
            sequence[last--] = 0;
        if (last < 0)
            break;
    }
    printf("%lu %lu %lu\n", sequences, packets, statuses);
    return 0;
}
