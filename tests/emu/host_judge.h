/* What the firmware must do, decided once more from the rules and not from its code, so that no error is shared: which
 * frames there are in a stream, who is armed, and how much throttle may be sent. */
#ifndef HOST_JUDGE_H
#define HOST_JUDGE_H

#include <stdbool.h>
#include <stdint.h>

#define FRAME 26 /* bytes of a channel frame */

struct judge {
    uint8_t stream[64];       /* bytes that are in no frame yet */
    int waiting;
    int lows;                 /* frames in a row that prepare arming */
    unsigned long since_good; /* ticks since a good frame */
    bool armed;
    bool disarms_only;        /* the frame that disarms does not prepare arming; needs a judge who knows of binding */
    unsigned flown, one, two; /* the highest throttle that may be flown, and those of the last two frames */
};

extern struct judge judge;
extern unsigned long judge_frames, judge_armings;

void judge_begin(void);
void judge_byte(uint8_t byte);
void judge_tick(void);
uint8_t judge_crc(const uint8_t *bytes, int count);
/* Look at the packet that the radio was given last, if there is a new one: why it is wrong, or NULL. */
const char *judge_packet(const uint8_t packet[32], uint8_t size, uint8_t channel, const uint8_t address[5]);

#endif
