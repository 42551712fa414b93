/* Frames from the host: sync, length, type, payload, CRC; found again after noise, byte by byte.
 *
 *   C8 | n | type | n - 2 bytes of payload | CRC-8 over type and payload
 *
 * Only the types below, each with its one length, are looked at: so the header alone is worth 24 bits
 * against noise, and no run of noise can make the parser wait for more than CRSF_LONGEST bytes.
 */
#ifndef CRSF_H
#define CRSF_H

#include <stdbool.h>
#include <stdint.h>

#define CRSF_SYNC 0xC8
#define CRSF_LONGEST 26 /* bytes of the longest frame */
#define CRSF_FRAMING 4  /* bytes of a frame around its payload */

enum crsf_type {
    CRSF_CHANNELS = 0x16,     /* host: sixteen channels of 11 bits, least significant bit first */
    CRSF_STATUS = 0xE0,       /* board: transmitter.c */
    CRSF_CONFIG = 0xE1,       /* board: result, then the configuration */
    CRSF_READ_CONFIG = 0xE2,  /* host: no payload */
    CRSF_WRITE_CONFIG = 0xE3, /* host: 'S' 'E' 'T', then the configuration */
    CRSF_BIND = 0xE4          /* host: 'B' 'I' 'N' 'D' */
};

#define CHANNELS 16
#define CHANNEL_LOW 172
#define CHANNEL_CENTER 992
#define CHANNEL_HIGH 1811

struct crsf {
    uint8_t bytes[CRSF_LONGEST];
    uint8_t count;
    bool whole;   /* bytes[] begins with a frame that was handed out */
    uint16_t bad; /* frames with a wrong CRC */
};

/* Take a byte. Afterwards crsf_next() hands out what is whole. */
void crsf_take(struct crsf *crsf, uint8_t byte);
/* True if there is a (further) good frame: type bytes[2], payload from bytes[3], until the next call. */
bool crsf_next(struct crsf *crsf);
/* Unpack the channels of a payload of 22 bytes; false if one is out of 172 ... 1811. */
bool crsf_channels(const uint8_t *payload, uint16_t channels[CHANNELS]);
/* Frame payload[count] in place: frame[3 ...] holds the payload. Returns the size of the frame. */
uint8_t crsf_frame(uint8_t *frame, uint8_t type, uint8_t count);

#endif
