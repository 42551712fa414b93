/* CRSF frames: sync, length, type, payload, CRC. The parser synchronizes again after noise, byte by byte; a frame whose
 * CRC is right but whose content makes no sense (a channel out of range, SET or BIND missing) is noise, too, so that no
 * good frame that begins within it is skipped.
 *
 *   C8 | n | type | n - 2 bytes of payload | CRC-8 over type and payload
 *
 * Only the types below, each with its fixed length, are accepted: so the header alone checks 24 bits, and noise
 * cannot make the parser wait for more than CRSF_LONGEST bytes.
 */
#ifndef CRSF_H
#define CRSF_H

#include <stdbool.h>
#include <stdint.h>

#define CRSF_SYNC 0xC8
#define CRSF_LONGEST 26 /* bytes of the longest frame */
#define CRSF_FRAMING 4  /* bytes of a frame beside its payload */

enum crsf_type {
    CRSF_CHANNELS = 0x16,     /* from the host: sixteen channels of 11 bits, least significant bit first */
    CRSF_STATUS = 0xE0,       /* to the host: see transmitter.c */
    CRSF_CONFIG = 0xE1,       /* to the host: result, then the configuration */
    CRSF_READ_CONFIG = 0xE2,  /* from the host: no payload */
    CRSF_WRITE_CONFIG = 0xE3, /* from the host: 'S' 'E' 'T', then the configuration */
    CRSF_BIND = 0xE4          /* from the host: 'B' 'I' 'N' 'D' */
};

#define CHANNELS 16
#define CHANNEL_LOW 172
#define CHANNEL_CENTER 992
#define CHANNEL_HIGH 1811

struct crsf {
    uint8_t bytes[CRSF_LONGEST];
    uint8_t count;
    bool whole;   /* bytes[] begins with the frame that crsf_next() found */
    uint16_t bad; /* frames with a wrong CRC, or a value out of range */
    uint16_t channels[CHANNELS]; /* of that frame if it is CRSF_CHANNELS, each 172 ... 1811 */
};

/* Append a byte. Then call crsf_next() until it returns false. */
void crsf_take(struct crsf *crsf, uint8_t byte);
/* True if there is another good frame: its type is bytes[2], its payload begins at bytes[3], until the next call. */
bool crsf_next(struct crsf *crsf);
/* Complete a frame whose payload of count bytes is in frame[3 ...]. Returns the size of the frame. */
uint8_t crsf_frame(uint8_t *frame, uint8_t type, uint8_t count);

#endif
