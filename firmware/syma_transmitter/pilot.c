#include "pilot.h"

enum channel { ROLL, PITCH, THROTTLE, YAW, ARM, RATE, FLIP };
#define SWITCH_HIGH 1500
#define SWITCH_LOW 500

/* Map 0 ... 1639 above CHANNEL_LOW to 0 ... 255, rounded. */
static uint8_t throttle_of(uint16_t channel)
{
    return (uint8_t)(((uint32_t)(channel - CHANNEL_LOW) * 10197u + 32768u) >> 16);
}

/* Map -820 ... 819 around CHANNEL_CENTER to -127 ... 127, rounded symmetrically. */
static int8_t stick_of(uint16_t channel)
{
    uint16_t size = channel < CHANNEL_CENTER ? CHANNEL_CENTER - channel : channel - CHANNEL_CENTER;
    int8_t stick = (int8_t)(((uint32_t)size * 10163u + 32768u) >> 16);
    return (int8_t)(channel < CHANNEL_CENTER ? -stick : stick);
}

struct range {
    int16_t low, high;
};

/* What is flown and what the two frames before said, neutral and a step on both sides. */
static struct range range_of(int16_t flown, int16_t one, int16_t two, int16_t step)
{
    struct range range = {0, 0};
    const int16_t values[3] = {flown, one, two};
    for (uint8_t i = 0; i < 3; i++) {
        if (values[i] < range.low)
            range.low = values[i];
        if (values[i] > range.high)
            range.high = values[i];
    }
    range.low = (int16_t)(range.low - step);
    range.high = (int16_t)(range.high + step);
    return range;
}

static int16_t within(struct range range, int16_t said)
{
    return said < range.low ? range.low : said > range.high ? range.high : said;
}

static void believe(struct pilot *pilot, const struct sticks *one, const struct sticks *two)
{
    const struct sticks *said = &pilot->heard;
    struct sticks *flown = &pilot->flown;
    uint8_t steps = (uint8_t)(1 + (uint8_t)pilot->age / STEP_TICKS); /* in flight, so the age is small */
    int16_t step = (int16_t)(STICK_STEP * steps), rise = (int16_t)(THROTTLE_STEP * steps);
    flown->throttle = (uint8_t)within(range_of(flown->throttle, one->throttle, two->throttle, rise), said->throttle);
    flown->pitch = (int8_t)within(range_of(flown->pitch, one->pitch, two->pitch, step), said->pitch);
    flown->yaw = (int8_t)within(range_of(flown->yaw, one->yaw, two->yaw, step), said->yaw);
    flown->roll = (int8_t)within(range_of(flown->roll, one->roll, two->roll, step), said->roll);
    flown->fast = said->fast && one->fast;
    flown->flip = said->flip && one->flip;
}

void pilot_begin(struct pilot *pilot, bool bind, bool in_flight)
{
    *pilot = (struct pilot){.state = in_flight ? STATE_FAILSAFE : STATE_LOCKED, .age = UINT16_MAX};
    if (bind)
        pilot_bind(pilot);
}

bool pilot_flying(const struct pilot *pilot)
{
    return pilot->state == STATE_ARMED || pilot->state == STATE_HOLDING;
}

bool pilot_bind(struct pilot *pilot)
{
    if (pilot_flying(pilot))
        return false;
    pilot->state = STATE_BINDING;
    pilot->bind_left = BIND_PACKETS;
    pilot->low_frames = 0;
    return true;
}

void pilot_bind_packet(struct pilot *pilot)
{
    if (pilot->state == STATE_BINDING && --pilot->bind_left == 0)
        pilot->state = STATE_LOCKED;
}

void pilot_frame(struct pilot *pilot, const uint16_t channels[CHANNELS])
{
    struct sticks *heard = &pilot->heard, one = pilot->heard, two = pilot->before;
    heard->throttle = throttle_of(channels[THROTTLE]);
    heard->pitch = stick_of(channels[PITCH]);
    heard->yaw = stick_of(channels[YAW]);
    heard->roll = stick_of(channels[ROLL]);
    heard->fast = channels[RATE] >= SWITCH_HIGH;
    heard->flip = channels[FLIP] >= SWITCH_HIGH;
    if (pilot_flying(pilot))
        believe(pilot, &one, &two);
    pilot->before = one;
    pilot->age = 0;
    if (pilot->state == STATE_BINDING)
        return;
    bool high = channels[ARM] >= SWITCH_HIGH;
    bool low = channels[ARM] <= SWITCH_LOW;
    if (pilot_flying(pilot)) {
        pilot->state = high ? STATE_ARMED : STATE_LOCKED;
        pilot->low_frames = 0;
    } else if (low) {
        pilot->state = STATE_LOCKED;
        if (heard->throttle)
            pilot->low_frames = 0;
        else if (pilot->low_frames < ARM_LOW_FRAMES)
            pilot->low_frames++;
    } else if (high && heard->throttle == 0 && pilot->low_frames == ARM_LOW_FRAMES) {
        pilot->state = STATE_ARMED;
        pilot->flown = (struct sticks){.fast = heard->fast && one.fast};
    } else {
        pilot->low_frames = 0;
    }
}

void pilot_tick(struct pilot *pilot)
{
    if (pilot->age < UINT16_MAX)
        pilot->age++;
    if (pilot->age >= FAILSAFE_TICKS) {
        pilot->low_frames = 0;
        if (pilot_flying(pilot))
            pilot->state = STATE_FAILSAFE;
    } else if (pilot->age >= NEUTRAL_TICKS && pilot->state == STATE_ARMED) {
        pilot->state = STATE_HOLDING;
    }
}

struct sticks pilot_sticks(const struct pilot *pilot)
{
    struct sticks sticks = {0};
    if (pilot->state == STATE_ARMED)
        sticks = pilot->flown;
    else if (pilot->state == STATE_HOLDING)
        sticks.throttle = pilot->flown.throttle;
    return sticks;
}
