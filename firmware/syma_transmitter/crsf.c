#include "crsf.h"

#include <string.h>

#include "config.h"
#include "crc8.h"

enum verdict { NO_FRAME, NOT_YET, BAD, GOOD };

/* Required value of the length byte for this type; 0 for unknown types. */
static uint8_t length_of(uint8_t type)
{
    switch (type) {
    case CRSF_CHANNELS: return 24;
    case CRSF_READ_CONFIG: return 2;
    case CRSF_WRITE_CONFIG: return 2 + 3 + CONFIG_SIZE;
    case CRSF_BIND: return 2 + 4;
    default: return 0;
    }
}

/* Unpack eight channels of 11 bits. Every shift is by a constant: others take this processor longer than a task may. */
static void unpack_eight(const uint8_t *p, uint16_t channels[8])
{
    channels[0] = (uint16_t)(p[0] | (p[1] & 7) << 8);
    channels[1] = (uint16_t)(p[1] >> 3 | p[2] << 5);
    channels[2] = (uint16_t)(p[2] >> 6 | p[3] << 2 | (p[4] & 1) << 10);
    channels[3] = (uint16_t)(p[4] >> 1 | p[5] << 7);
    channels[4] = (uint16_t)(p[5] >> 4 | p[6] << 4);
    channels[5] = (uint16_t)(p[6] >> 7 | p[7] << 1 | (p[8] & 3) << 9);
    channels[6] = (uint16_t)(p[8] >> 2 | p[9] << 6);
    channels[7] = (uint16_t)(p[9] >> 5 | p[10] << 3);
}

/* Unpack the channels of a payload of 22 bytes; false if one is out of 172 ... 1811. */
static bool unpack(const uint8_t *payload, uint16_t channels[CHANNELS])
{
    unpack_eight(payload, channels);
    unpack_eight(payload + 11, channels + 8);
    for (uint8_t i = 0; i < CHANNELS; i++) {
        channels[i] &= 0x7FF;
        if (channels[i] < CHANNEL_LOW || channels[i] > CHANNEL_HIGH)
            return false;
    }
    return true;
}

/* Noise has the right CRC once in 256 times: what it says must make sense, too. */
static bool sensible(struct crsf *crsf, const uint8_t *bytes)
{
    switch (bytes[2]) {
    case CRSF_CHANNELS: return unpack(bytes + 3, crsf->channels);
    case CRSF_WRITE_CONFIG: return memcmp(bytes + 3, "SET", 3) == 0;
    case CRSF_BIND: return memcmp(bytes + 3, "BIND", 4) == 0;
    default: return true;
    }
}

static enum verdict judge(struct crsf *crsf, uint8_t start)
{
    const uint8_t *bytes = crsf->bytes + start;
    uint8_t count = (uint8_t)(crsf->count - start);
    if (bytes[0] != CRSF_SYNC)
        return NO_FRAME;
    if (count < 3)
        return NOT_YET;
    uint8_t length = bytes[1];
    if (length == 0 || length != length_of(bytes[2]))
        return NO_FRAME;
    if (count < length + 2)
        return NOT_YET;
    bool good = crc8(bytes + 2, (uint8_t)(length - 1)) == bytes[length + 1] && sensible(crsf, bytes);
    return good ? GOOD : BAD;
}

static void drop(struct crsf *crsf, uint8_t count)
{
    crsf->count = (uint8_t)(crsf->count - count);
    memmove(crsf->bytes, crsf->bytes + count, crsf->count);
}

void crsf_take(struct crsf *crsf, uint8_t byte)
{
    /* There is always room: crsf_next() leaves fewer bytes than the longest frame. */
    crsf->bytes[crsf->count++] = byte;
}

bool crsf_next(struct crsf *crsf)
{
    if (crsf->whole)
        drop(crsf, (uint8_t)(crsf->bytes[1] + 2));
    crsf->whole = false;
    uint8_t start = 0;
    enum verdict verdict = NO_FRAME;
    for (; start < crsf->count; start++) {
        verdict = judge(crsf, start);
        if (verdict == BAD)
            crsf->bad++;
        if (verdict == NOT_YET || verdict == GOOD)
            break;
    }
    if (start)
        drop(crsf, start);
    crsf->whole = verdict == GOOD;
    return crsf->whole;
}

uint8_t crsf_frame(uint8_t *frame, uint8_t type, uint8_t count)
{
    frame[0] = CRSF_SYNC;
    frame[1] = (uint8_t)(count + 2);
    frame[2] = type;
    frame[3 + count] = crc8(frame + 2, (uint8_t)(count + 1));
    return (uint8_t)(count + CRSF_FRAMING);
}
