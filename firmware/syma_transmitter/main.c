#include <avr/wdt.h>

#include "board_avr.h"
#include "transmitter.h"

int main(void)
{
    board_begin();
    transmitter_begin(board_start());
    for (;;) {
        if (board_tick()) {
            transmitter_tick();
            wdt_reset();
        } else if (board_half_tick()) {
            transmitter_prepare();
        } else if (!board_has_time() || !transmitter_work()) {
            board_rest();
        }
    }
}
