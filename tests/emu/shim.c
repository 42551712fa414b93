/* An ATmega328P in lock-step, for ctypes: libsimavr with the traps of its release 1.6 taken care of.
 *
 * The caller says to which cycle to run; what the firmware does on SPI and port B is handed to two functions of
 * the caller as it happens. Linked with libsimavr (GPL-3 or later): for the tests only, never in the package.
 */
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <simavr/avr_eeprom.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_spi.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>

typedef uint8_t (*exchange_fn)(uint8_t mosi, uint64_t cycle);
typedef void (*pin_fn)(int pin, int level, uint64_t cycle);

#define QUEUE (1u << 20) /* bytes to and from the serial port, powers of two */
#define BYTE_CYCLES 1360 /* of ten bits at the firmware's 117647 baud */
/* simavr counts 11 bits a byte, and a byte that comes before the last was read waits for twice that: so its own
 * time is made a little shorter than the true one, which leaves an interrupt room to read it. */
#define SIMAVR_BYTE_CYCLES 1250
#define MCUSR 0x54
#define SPCR 0x4C
#define SPSR 0x4D
#define SPDR 0x4E
#define UDR 0xC6

struct emu {
    avr_t *avr;
    avr_irq_t *spi_in, *uart_in;
    avr_spi_t *spi;
    avr_uart_t *uart;
    exchange_fn exchange;
    pin_fn pin;
    uint8_t in[QUEUE], out[QUEUE];
    uint32_t in_head, in_tail, out_head, out_tail;
    uint64_t last_in; /* cycle at which the last byte from the host began */
    uint8_t spi_out;
    uint8_t healed[16]; /* what a hang has overwritten */
    uint32_t heal_place, heal_count;
};

static avr_cycle_count_t nothing(avr_t *avr, avr_cycle_count_t when, void *param)
{
    (void)avr, (void)when, (void)param;
    return 0;
}

static void on_spi(avr_irq_t *irq, uint32_t value, void *param)
{
    struct emu *emu = param;
    (void)irq;
    avr_raise_irq(emu->spi_in, emu->exchange((uint8_t)value, emu->avr->cycle));
}

/* simavr 1.6 takes 100 us for every byte on SPI, whatever its clock: these two do it in the true time. */
static avr_cycle_count_t spi_done(avr_t *avr, avr_cycle_count_t when, void *param)
{
    struct emu *emu = param;
    avr_spi_t *spi = emu->spi;
    (void)when;
    spi->input_data_register = emu->exchange(emu->spi_out, avr->cycle);
    avr_raise_interrupt(avr, &spi->spi);
    return 0;
}

static void spi_write(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    static const uint8_t divider[8] = {4, 16, 64, 128, 2, 8, 32, 64}; /* by SPI2X SPR1 SPR0 */
    struct emu *emu = param;
    avr_core_watch_write(avr, address, value);
    avr_regbit_clear(avr, emu->spi->spi.raised);
    emu->spi_out = value;
    int clock = (avr->data[SPSR] & 1) << 2 | (avr->data[SPCR] & 3);
    avr_cycle_timer_register(avr, 8u * divider[clock], spi_done, emu);
}

static void on_uart(avr_irq_t *irq, uint32_t value, void *param)
{
    struct emu *emu = param;
    (void)irq;
    emu->out[emu->out_head++ % QUEUE] = (uint8_t)value;
}

static void on_pin(avr_irq_t *irq, uint32_t value, void *param)
{
    struct emu *emu = param;
    emu->pin((int)irq->irq, (int)(value & 1), emu->avr->cycle);
}

static void no_sleep(avr_t *avr, avr_cycle_count_t cycles)
{
    (void)avr, (void)cycles;
}

static void quiet(avr_t *avr, const int level, const char *format, va_list words)
{
    (void)avr, (void)level, (void)format, (void)words;
}

/* Serial flags belong to the port, and a reset clears them: no echo on stdout, no sleep when polled. */
static void set_serial_flags(struct emu *emu)
{
    uint32_t flags = 0;
    avr_ioctl(emu->avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
}

static void heal(avr_t *avr)
{
    struct emu *emu = avr->custom.data;
    memcpy(avr->flash + emu->heal_place, emu->healed, emu->heal_count);
    emu->heal_count = 0;
}

void *emu_open(const char *elf, exchange_fn exchange, pin_fn pin, int slow_spi)
{
    elf_firmware_t firmware;
    memset(&firmware, 0, sizeof firmware);
    avr_global_logger_set(quiet);
    avr_t *avr = avr_make_mcu_by_name("atmega328p");
    if (!avr || elf_read_firmware(elf, &firmware) != 0)
        return NULL;
    struct emu *emu = calloc(1, sizeof *emu);
    emu->avr = avr;
    avr->custom.data = emu;
    avr->reset = heal;
    emu->exchange = exchange;
    emu->pin = pin;
    avr_init(avr);
    avr->frequency = 16000000;
    avr->sleep = no_sleep;
    avr_load_firmware(avr, &firmware);
    avr->frequency = 16000000;
    set_serial_flags(emu);
    emu->spi_in = avr_io_getirq(avr, AVR_IOCTL_SPI_GETIRQ(0), SPI_IRQ_INPUT);
    emu->spi = avr->io[AVR_DATA_TO_IO(SPDR)].w.param;
    if (!slow_spi) {
        avr->io[AVR_DATA_TO_IO(SPDR)].w.c = spi_write;
        avr->io[AVR_DATA_TO_IO(SPDR)].w.param = emu;
    }
    emu->uart = avr->io[AVR_DATA_TO_IO(UDR)].w.param;
    emu->uart_in = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_SPI_GETIRQ(0), SPI_IRQ_OUTPUT), on_spi, emu);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), on_uart, emu);
    for (int i = 1; i <= 2; i++)
        avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('B'), i), on_pin, emu);
    return emu;
}

void emu_close(struct emu *emu)
{
    avr_terminate(emu->avr);
    free(emu->avr);
    free(emu);
}

uint64_t emu_cycle(struct emu *emu)
{
    return emu->avr->cycle;
}

/* False if the processor stopped for good. */
int emu_run_to(struct emu *emu, uint64_t cycle)
{
    avr_t *avr = emu->avr;
    uint64_t stop = 0;
    while (avr->cycle < cycle) {
        bool waiting = emu->in_head != emu->in_tail;
        if (waiting && avr->cycle >= emu->last_in + BYTE_CYCLES) {
            emu->last_in = avr->cycle;
            emu->uart->cycles_per_byte = SIMAVR_BYTE_CYCLES;
            avr_raise_irq(emu->uart_in, emu->in[emu->in_tail++ % QUEUE]);
        }
        uint64_t next = waiting && emu->last_in + BYTE_CYCLES < cycle ? emu->last_in + BYTE_CYCLES : cycle;
        /* A sleeping processor jumps to the next timer: there must be one where we want to act. A reset forgets
         * timers; and one that is late by a cycle has status 0, so no work may be left to the timer itself. */
        if (next != stop || !avr_cycle_timer_status(avr, nothing, emu)) {
            stop = next;
            avr_cycle_timer_register(avr, next > avr->cycle ? next - avr->cycle : 1, nothing, emu);
        }
        int state = avr_run(avr);
        if (state == cpu_Done || state == cpu_Crashed)
            return 0;
    }
    avr_cycle_timer_cancel(avr, nothing, emu);
    return 1;
}

void emu_uart_in(struct emu *emu, const uint8_t *bytes, uint32_t count)
{
    while (count--)
        emu->in[emu->in_head++ % QUEUE] = *bytes++;
}

uint32_t emu_uart_waiting(struct emu *emu)
{
    return emu->in_head - emu->in_tail;
}

uint64_t emu_uart_last(struct emu *emu)
{
    return emu->last_in;
}

uint32_t emu_uart_out(struct emu *emu, uint8_t *bytes, uint32_t room)
{
    uint32_t count = 0;
    while (count < room && emu->out_tail != emu->out_head)
        bytes[count++] = emu->out[emu->out_tail++ % QUEUE];
    return count;
}

/* Pull the reset line, or take the power away: with flags as the processor would find them in MCUSR. */
void emu_reset(struct emu *emu, uint8_t flags, int keep_ram)
{
    avr_t *avr = emu->avr;
    uint16_t first = avr->ioend + 1, size = (uint16_t)(avr->ramend - avr->ioend);
    uint8_t *ram = malloc(size);
    memcpy(ram, avr->data + first, size);
    avr_reset(avr);
    if (keep_ram)
        memcpy(avr->data + first, ram, size);
    else
        memset(avr->data + first, 0x5A, size);
    free(ram);
    avr->data[MCUSR] = flags;
    set_serial_flags(emu);
}

/* Overwrite code with a loop that never ends; the next reset brings the code back. */
void emu_hang(struct emu *emu, uint32_t place, const uint8_t *code, uint32_t count)
{
    memcpy(emu->healed, emu->avr->flash + place, count);
    memcpy(emu->avr->flash + place, code, count);
    emu->heal_place = place;
    emu->heal_count = count;
}

void emu_ram(struct emu *emu, uint16_t place, uint8_t *bytes, uint16_t count, int write)
{
    if (write)
        memcpy(emu->avr->data + place, bytes, count);
    else
        memcpy(bytes, emu->avr->data + place, count);
}

void emu_eeprom(struct emu *emu, uint8_t *bytes, uint16_t count, int write)
{
    avr_eeprom_desc_t part = {.ee = bytes, .offset = 0, .size = count};
    avr_ioctl(emu->avr, write ? AVR_IOCTL_EEPROM_SET : AVR_IOCTL_EEPROM_GET, &part);
}
