#include "board_avr.h"

#include <avr/eeprom.h>
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>
#include <util/atomic.h>

#define CYCLES_PER_US (F_CPU / 1000000UL)
#define TICK_CYCLES (4000UL * CYCLES_PER_US)
#define HALF_CYCLES (2000UL * CYCLES_PER_US)
#define LAST_START (TICK_CYCLES - WORK_US * CYCLES_PER_US)

#define CE PB1
#define CSN PB2
#define MOSI PB3
#define SCK PB5

/* Kept over a reset (.noinit): the reset flags, of the processor or of a boot loader, and a mark that we ran before. */
#define RAN_BEFORE 0xB1D5
static uint8_t reset_flags __attribute__((section(".noinit")));
static uint16_t ran_before __attribute__((section(".noinit")));

/* Runs before the C start-up code, which overwrites r2, where the boot loader Optiboot leaves the flags it cleared. */
void keep_reset_flags(void) __attribute__((naked, used, section(".init3")));
void keep_reset_flags(void)
{
    uint8_t from_loader;
    __asm__ volatile("mov %0, r2" : "=r"(from_loader));
    uint8_t flags = MCUSR;
    MCUSR = 0;
    if (flags == 0 && from_loader < 16)
        flags = from_loader;
    reset_flags = flags;
    /* After a reset by the watchdog it keeps running, with its shortest timeout. */
    wdt_enable(WDTO_60MS);
}

enum start board_start(void)
{
    bool warm = ran_before == RAN_BEFORE;
    ran_before = RAN_BEFORE;
    if (reset_flags & _BV(WDRF))
        return START_WATCHDOG;
    /* If the mark is still there, the supply was off for a moment at most, whatever the flags say. */
    if (warm || (reset_flags && !(reset_flags & _BV(PORF))))
        return START_OTHER_RESET;
    return START_POWER_ON;
}

/* ---- time ---- */

static volatile bool tick, half_tick;

ISR(TIMER1_COMPA_vect)
{
    tick = true;
}

ISR(TIMER1_COMPB_vect)
{
    half_tick = true;
}

bool board_tick(void)
{
    bool was = tick;
    if (was)
        tick = false;
    return was;
}

bool board_half_tick(void)
{
    bool was = half_tick;
    if (was)
        half_tick = false;
    return was;
}

bool board_has_time(void)
{
    uint16_t now;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        now = TCNT1;
    }
    return now < LAST_START && !tick;
}

/* ---- serial ---- */

#define RX_SIZE 64 /* bytes; both sizes must be powers of two */
#define TX_SIZE 64
static volatile uint8_t rx[RX_SIZE], rx_in, rx_out, lost;
static volatile uint8_t tx[TX_SIZE], tx_in, tx_out;

ISR(USART_RX_vect)
{
    uint8_t status = UCSR0A;
    uint8_t byte = UDR0;
    uint8_t next = (rx_in + 1) & (RX_SIZE - 1);
    if (status & (_BV(FE0) | _BV(DOR0)))
        lost++;
    if (status & _BV(FE0))
        return;
    if (next == rx_out) {
        lost++;
        return;
    }
    rx[rx_in] = byte;
    rx_in = next;
}

ISR(USART_UDRE_vect)
{
    UDR0 = tx[tx_out];
    tx_out = (tx_out + 1) & (TX_SIZE - 1);
    /* Disable the interrupt with the last byte, not one interrupt later. */
    if (tx_out == tx_in)
        UCSR0B &= (uint8_t)~_BV(UDRIE0);
}

bool serial_read(uint8_t *byte)
{
    if (rx_out == rx_in)
        return false;
    *byte = rx[rx_out];
    rx_out = (rx_out + 1) & (RX_SIZE - 1);
    return true;
}

bool serial_write(const uint8_t *bytes, uint8_t count)
{
    uint8_t room = (tx_out - tx_in - 1) & (TX_SIZE - 1);
    if (count > room)
        return false;
    while (count--) {
        tx[tx_in] = *bytes++;
        tx_in = (tx_in + 1) & (TX_SIZE - 1);
    }
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        UCSR0B |= _BV(UDRIE0);
    }
    return true;
}

uint8_t serial_lost(void)
{
    return lost;
}

/* ---- radio ---- */

uint8_t spi_exchange(uint8_t out)
{
    SPDR = out;
    while (!(SPSR & _BV(SPIF)))
        ;
    return SPDR;
}

void radio_select(bool selected)
{
    if (selected)
        PORTB &= (uint8_t)~_BV(CSN);
    else
        PORTB |= _BV(CSN);
}

void radio_enable(bool enabled)
{
    if (enabled)
        PORTB |= _BV(CE);
    else
        PORTB &= (uint8_t)~_BV(CE);
}

/* ---- memory ---- */

uint8_t memory_read(uint8_t place)
{
    return eeprom_read_byte((const uint8_t *)(uintptr_t)place);
}

bool memory_idle(void)
{
    return eeprom_is_ready();
}

void memory_write(uint8_t place, uint8_t byte)
{
    eeprom_write_byte((uint8_t *)(uintptr_t)place, byte);
}

/* ---- start and sleep ---- */

void board_begin(void)
{
    PORTB |= _BV(CSN);
    DDRB |= _BV(CE) | _BV(CSN) | _BV(MOSI) | _BV(SCK);
    SPCR = _BV(SPE) | _BV(MSTR); /* F_CPU / 4 = 4 MHz; the radio allows 10 MHz, jumper wires less */
    SPSR = 0;

    UBRR0 = 16; /* with U2X 117647 baud, 2.1 % too fast, as the Arduino library sets it */
    UCSR0A = _BV(U2X0);
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
    UCSR0B = _BV(RXCIE0) | _BV(RXEN0) | _BV(TXEN0);

    TCCR1A = 0;
    OCR1A = TICK_CYCLES - 1;
    OCR1B = HALF_CYCLES - 1;
    TCNT1 = 0;
    TIMSK1 = _BV(OCIE1A) | _BV(OCIE1B);
    TCCR1B = _BV(WGM12) | _BV(CS10);

    SMCR = 0; /* idle mode: timer and serial port keep running */
    sei();
}

void board_rest(void)
{
    /* Interrupts are disabled between the test and the sleep, so that none is missed. */
    cli();
    if (tick || half_tick || (rx_in != rx_out && board_has_time())) {
        sei();
        return;
    }
    SMCR = _BV(SE);
    sei();
    sleep_cpu();
    SMCR = 0;
}
