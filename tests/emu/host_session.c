/* Plays a session: lines of "cycle hexbytes" on stdin, in order; then "end cycle". Prints "cycle kind value" for
 * everything that reaches the radio and the host, as the avr8js program does. Bytes arrive whole, at once. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "host_board.h"
#include "transmitter.h"

#define TICK 64000ul
#define HALF 32000ul
#define SPI_BYTE 40

static unsigned long long now;

static void print(char kind, uint8_t value)
{
    if (kind == 'S')
        now += SPI_BYTE;
    printf("%llu %c %u\n", now, kind, value);
}

static void work(void)
{
    uint8_t bytes[64];
    while (transmitter_work()) {
        uint32_t count = host_serial_out(bytes, sizeof bytes);
        for (uint32_t i = 0; i < count; i++)
            print('U', bytes[i]);
    }
}

/* Time passes until this cycle, in halves of a tick. */
static void run_to(unsigned long long cycle)
{
    static unsigned long long half = 1;
    for (; half * HALF <= cycle; half++) {
        if (now < half * HALF)
            now = half * HALF;
        if (half % (TICK / HALF))
            transmitter_prepare();
        else
            transmitter_tick();
        work();
    }
    if (now < cycle)
        now = cycle;
}

int main(void)
{
    static char line[1 << 16];
    memset(host_memory, 0xFF, sizeof host_memory);
    host_log = print;
    host_power_on();
    transmitter_begin(START_POWER_ON);
    while (fgets(line, sizeof line, stdin)) {
        char *hex;
        if (strncmp(line, "end ", 4) == 0) {
            run_to(strtoull(line + 4, NULL, 10));
            return 0;
        }
        run_to(strtoull(line, &hex, 10));
        for (unsigned int byte; sscanf(hex, " %2x", &byte) == 1; hex += hex[0] == ' ' ? 3 : 2) {
            uint8_t one = (uint8_t)byte;
            host_serial_in(&one, 1);
        }
        work();
    }
    return 1;
}
