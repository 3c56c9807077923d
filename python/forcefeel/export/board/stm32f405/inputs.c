/* What QEMU does not emulate of an STM32F405: clock, converter and pins. emulated.c stands in for it there. */
#include "board.h"
#include "stm32f405.h"

#include <math.h>

#define WHOLE 4095U
#define MIDDLE 2048.0F
#define PATIENCE 10000U /* of a loop, some 0.3 ms */
/* Pins of port B, pulled up: an open wire stops the loader. */
#define EMERGENCY_STOP_OPEN (1U << 12) /* closed: may run */
#define DRIVE_FAULT_OPEN (1U << 13) /* closed: the drive is well */
#define REQUEST_OPEN (1U << 14) /* closed: on */
#define ACKNOWLEDGE_OPEN (1U << 15) /* closed: acknowledged */

static void await(volatile uint32_t *flags, uint32_t flag)
{
    for (uint32_t k = 0U; (*flags & flag) == 0U; ++k) {
        if (k > 100U * PATIENCE) {
            fault();
        }
    }
}

/* 168 MHz from the crystal; without it the drive stays off. */
void clock_begin(void)
{
    RCC_CR |= 1U << 16;
    await(&RCC_CR, 1U << 17);
    FLASH_ACR = 0x705U; /* caches, five wait states */
    RCC_PLLCFGR = (7U << 24) | (1U << 22) | (336U << 6) | (HSE_HZ / 1000000U);
    RCC_CFGR = (4U << 13) | (5U << 10); /* APB2 84 MHz, APB1 42 MHz */
    RCC_CR |= (1U << 24) | (1U << 19); /* with its supervision */
    await(&RCC_CR, 1U << 25);
    RCC_CFGR |= 2U;
    await(&RCC_CFGR, 2U << 2);
}

/* PA0 to PA3 one after another, 4.6 us each, once TIM2 begins a period. */
void inputs_begin(void)
{
    GPIOB_PUPDR |= 0x55000000U;
    ADC_CCR = 1U << 16; /* 21 MHz */
    ADC1_SMPR2 = 0x924U; /* 84 cycles */
    ADC1_JSQR = (3U << 20) | (3U << 15) | (2U << 10) | (1U << 5);
    ADC1_CR1 = 1U << 8; /* scan */
    ADC1_CR2 = (1U << 20) | (3U << 16) | 1U; /* rising edge of TIM2's update; on */
}

void read_inputs(forcefeel_input *in)
{
    static uint32_t was_off;
    uint32_t k = 0U;
    while (((ADC1_SR & 0x4U) == 0U) && (k < PATIENCE)) {
        ++k;
    }
    in->missed = (k < PATIENCE) ? 0U : in->missed + 1U;
    ADC1_SR = 0U;
    for (uint32_t channel = 0U; channel < 4U; ++channel) {
        const uint32_t code = ADC1_JDR(channel);
        const float value = ((float)code - MIDDLE) * (board_ranges[channel] / MIDDLE);
        /* At an end of the converter the sensor shows no number: a broken wire, or beyond its range. */
        in->sensors[channel] = ((code == 0U) || (code >= WHOLE)) ? NAN : value;
    }
#if !BOARD_GRIP_SENSOR
    in->sensors[3] = 0.0F;
#endif
    const uint32_t pins = GPIOB_IDR;
    /* After a start, and so after a fault, the switch has to be seen off before it is on. */
    was_off |= pins & REQUEST_OPEN;
    in->request = ((was_off != 0U) && ((pins & REQUEST_OPEN) == 0U)) ? FORCEFEEL_ACTIVE : FORCEFEEL_OFF;
    in->flags = (((pins & EMERGENCY_STOP_OPEN) != 0U) ? FORCEFEEL_EMERGENCY_STOP : 0U)
        | (((pins & DRIVE_FAULT_OPEN) != 0U) ? FORCEFEEL_DRIVE_FAULT : 0U)
        | (((pins & ACKNOWLEDGE_OPEN) == 0U) ? FORCEFEEL_ACKNOWLEDGED : 0U)
        | FORCEFEEL_DRIVE_ACTS; /* for a drive that tells, give it a pin */
}

void stopped(void)
{
    for (;;) {
    }
}
