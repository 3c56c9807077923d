/* Start of a Cortex-M4F or M7 under QEMU (mps2-an386, mps2-an500): vectors, floating-point unit, newlib's semihosting, main. */
#include <stdio.h>
#include <unistd.h>

void stack_top(void); /* an address of board.ld, no function */
void initialise_monitor_handles(void);
int main(void);
void reset(void);
void fault(void);
void begin(void);

/* In assembly alone: a compiler may use the unit, or save its registers, before any line of C has switched it on. */
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

/* QEMU ends with main's status. What changes is zero, or loaded by QEMU itself. */
__attribute__((noreturn)) void begin(void)
{
    initialise_monitor_handles();
    const int status = main();
    (void)fflush(stdout);
    _exit(status);
}

/* QEMU ends with status 1: SYS_EXIT, "run-time error unknown". */
__attribute__((naked, noreturn)) void fault(void)
{
    __asm__("movs r0, #0x18\n"
            "ldr r1, =0x20023\n"
            "bkpt 0xAB\n"
            "b .\n");
}

__attribute__((section(".vectors"), used)) static void (*const vectors[16])(void) = {
    stack_top, reset, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault,
};
