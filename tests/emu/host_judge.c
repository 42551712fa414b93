#include "host_judge.h"

#include <string.h>

struct judge judge;
unsigned long judge_frames, judge_armings;

static unsigned channel(const uint8_t *payload, int which)
{
    unsigned value = 0;
    for (int bit = 0; bit < 11; bit++) {
        int place = which * 11 + bit;
        value |= (unsigned)(payload[place / 8] >> (place % 8) & 1) << bit;
    }
    return value;
}

uint8_t judge_crc(const uint8_t *bytes, int count)
{
    uint8_t crc = 0;
    while (count--) {
        crc ^= *bytes++;
        for (int bit = 0; bit < 8; bit++)
            crc = (uint8_t)(crc & 0x80 ? crc << 1 ^ 0xD5 : crc << 1);
    }
    return crc;
}

void judge_begin(void)
{
    judge = (struct judge){.since_good = 61};
}

/* Whether the bytes that wait begin with a frame: its size, 0 if they do not, -1 if more of them must come first. */
static int frame_size(const uint8_t *f, int count)
{
    static const struct { uint8_t type, size; const char *begin; } known[] = {
        {0x16, FRAME, ""}, {0xE2, 4, ""}, {0xE3, 21, "SET"}, {0xE4, 8, "BIND"},
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
        if (judge_crc(f + 2, size - 3) != f[size - 1] || memcmp(f + 3, known[i].begin, strlen(known[i].begin)) != 0)
            return 0;
        for (int which = 0; f[2] == 0x16 && which < 16; which++)
            if (channel(f + 3, which) < 172 || channel(f + 3, which) > 1811)
                return 0;
        return size;
    }
    return 0;
}

/* One frame alone raises the throttle by 38 of 255 for each 40 ms since the last; 1 more for rounding. */
static void judge_throttle(unsigned value)
{
    unsigned said = ((value - 172) * 510 + 1639) / 3278 + 1;
    unsigned most = judge.one > judge.two ? judge.one : judge.two;
    most = (most > judge.flown ? most : judge.flown) + 38 * (1 + (unsigned)judge.since_good / 10);
    judge.flown = said < most ? said : most;
    judge.two = judge.one;
    judge.one = said;
}

static void judge_channels(const uint8_t *payload)
{
    unsigned arm = channel(payload, 4);
    bool idle = channel(payload, 2) <= 175, flying = judge.armed;
    judge_throttle(channel(payload, 2));
    judge_frames++;
    judge.since_good = 0;
    if (arm <= 500) {
        judge.lows = idle && !(flying && judge.disarms_only) ? judge.lows + 1 : 0;
        judge.armed = false;
        return;
    }
    if (arm < 1500) {
        judge.armed = false;
    } else if (!flying && idle && judge.lows >= 3) {
        judge.armed = true;
        judge.flown = 0;
        judge_armings++;
    }
    judge.lows = 0;
}

void judge_byte(uint8_t byte)
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

void judge_tick(void)
{
    if (++judge.since_good >= 61)
        judge.armed = false, judge.lows = 0;
}

const char *judge_packet(const uint8_t packet[32], uint8_t size, uint8_t channel_now, const uint8_t address[5])
{
    uint8_t sum = 0;
    for (int i = 0; i < 9; i++)
        sum ^= packet[i];
    if (size != 10 || channel_now > 83 || packet[9] != (uint8_t)(sum + 0x55))
        return "malformed";
    if (memcmp(address, "\xAB\xAC\xAD\xAE\xAF", 5) == 0)
        return memcmp(packet + 5, "\xAA\xAA\xAA", 3) == 0 ? NULL : "malformed bind packet";
    if (packet[0] && !judge.armed)
        return "throttle while disarmed";
    return packet[0] > judge.flown ? "more throttle than two frames said" : NULL;
}
