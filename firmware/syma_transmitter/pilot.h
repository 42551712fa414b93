/* Who may fly: arming, the failsafe and the sticks that go on the air. Nothing here knows of serial or radio. */
#ifndef PILOT_H
#define PILOT_H

#include <stdbool.h>
#include <stdint.h>

#include "crsf.h"

#define BIND_PACKETS 345   /* 1.38 s */
#define TICK_MS 4
#define NEUTRAL_TICKS 26   /* age of the last good frame from which sticks are neutral: 100 ... 104 ms */
#define FAILSAFE_TICKS 61  /* and from which the throttle is zero: 240 ... 244 ms */
#define ARM_LOW_FRAMES 3   /* good frames in a row that show arm low and throttle zero before arm high counts */

enum state {
    STATE_BINDING,  /* bind packets; what the host says does not count */
    STATE_LOCKED,   /* throttle zero; may be armed */
    STATE_ARMED,    /* the host flies */
    STATE_HOLDING,  /* no good frame for 100 ms: sticks neutral, throttle as it was */
    STATE_FAILSAFE  /* none for 240 ms, or a reset in flight: throttle zero until the host disarms */
};

struct sticks {
    uint8_t throttle;       /* 0 ... 255 */
    int8_t pitch, yaw, roll; /* -127 ... 127; forward, right, right */
    bool fast, flip;
};

struct pilot {
    enum state state;
    uint8_t low_frames;      /* of ARM_LOW_FRAMES */
    uint16_t age;            /* of the last good frame, in ticks, saturated */
    uint16_t bind_left;      /* bind packets to go */
    struct sticks heard;     /* what the last good frame said */
};

/* Begin with the bind packets, or locked; in_flight: after a reset that was no power-on. */
void pilot_begin(struct pilot *pilot, bool bind, bool in_flight);
/* A good frame's channels: AETR, arm on 5, rate on 6, flip on 7. */
void pilot_frame(struct pilot *pilot, const uint16_t channels[CHANNELS]);
/* 4 ms have passed. */
void pilot_tick(struct pilot *pilot);
/* Begin to bind; false while motors may be turning. */
bool pilot_bind(struct pilot *pilot);
/* A bind packet went out. */
void pilot_bind_packet(struct pilot *pilot);
/* What goes on the air now. */
struct sticks pilot_sticks(const struct pilot *pilot);
bool pilot_flying(const struct pilot *pilot);

#endif
