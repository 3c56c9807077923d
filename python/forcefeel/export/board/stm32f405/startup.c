/* Start, vectors, stack and faults of an STM32F405. */
#include "board.h"
#include "stm32f405.h"

#define PAINT 0xA5A5A5A5U
#define VECTORS 98U /* 16 of the processor, 82 of the chip */

extern uint32_t data_load[], data_begin[], data_end[], bss_begin[], bss_end[], stack_bottom[], stack_top[]; /* stm32f405.ld */
int main(void);
void reset(void);
void begin(void);
void after_fault(void);

/* In assembly alone: a compiler may use the floating-point unit before any line of C has switched it on. */
__attribute__((naked, noreturn)) void reset(void)
{
    __asm__("ldr r0, =0xE000ED88\n" /* CPACR */
            "ldr r1, [r0]\n"
            "orr r1, r1, #0x00F00000\n" /* coprocessors 10 and 11 */
            "str r1, [r0]\n"
            "dsb\n"
            "isb\n"
            "b begin\n");
}

__attribute__((noreturn)) void begin(void)
{
    const uint32_t *from = data_load;
    for (uint32_t *to = data_begin; to < data_end; ++to) {
        *to = *from++;
    }
    for (uint32_t *to = bss_begin; to < bss_end; ++to) {
        *to = 0U;
    }
    for (volatile uint32_t *to = stack_bottom; to < (uint32_t *)__builtin_frame_address(0) - 32; ++to) {
        *to = PAINT;
    }
    (void)main();
    fault();
}

uint32_t stack_bytes(void)
{
    return (uint32_t)((char *)stack_top - (char *)stack_bottom);
}

uint32_t stack_never_used(void)
{
    const volatile uint32_t *word = stack_bottom;
    while ((word < stack_top) && (*word == PAINT)) {
        ++word;
    }
    return (uint32_t)((const volatile char *)word - (char *)stack_bottom);
}

void check_stack(void)
{
    if (*(volatile uint32_t *)stack_bottom != PAINT) {
        fault();
    }
}

/* With a stack of its own: the old one may be what faulted. */
__attribute__((naked, noreturn)) void fault(void)
{
    __asm__("cpsid i\n"
            "ldr r0, =stack_top\n"
            "mov sp, r0\n"
            "b after_fault\n");
}

/* The drive without power, its command zero. Nothing refreshes the watchdog any more: it starts the board again, with the drive off. */
__attribute__((noreturn)) void after_fault(void)
{
    drive_off();
    stopped();
}

/* An interrupt that was not asked for is a fault, as is the loss of the crystal (NMI). */
__attribute__((section(".vectors"), used)) static void (*const vectors[VECTORS])(void) = {
    (void (*)(void))(void *)stack_top, reset, [2 ... 43] = fault, [44] = period /* TIM2 */, [45 ... VECTORS - 1U] = fault,
};
