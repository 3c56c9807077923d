/* One axis on an STM32F405: TIM2 calls a period of the law; the main program sends telemetry. */
#include "board.h"
#include "stm32f405.h"

#define ENABLE 0U /* PB0, high: the drive has power */
#define MIDDLE 2048
#define SWING 2047
#define BARRIER() __asm volatile("" ::: "memory") /* a frame is whole before it is pending, and sent after */

/* A frame of telemetry, little-endian; telemetry.py reads it. */
typedef struct {
    uint32_t period;
    float command, torque, angle, rate;
    uint32_t acting, tripped;
    uint16_t stack_free; /* bytes of the stack that were never used */
    uint16_t busy; /* longest time of a period's interrupt, in thousandths of the period */
    uint8_t state, enable, status, late;
} frame;

forcefeel_output board_output;
static forcefeel_axis axis;
static float command; /* on its way to the drive */
static uint32_t periods, late, longest, stack_free;
static frame pending;
static volatile uint32_t is_pending;

static void convert(float value)
{
    const float steps = value * ((float)SWING / BOARD_COMMAND_RANGE);
    const float within = (steps > (float)SWING) ? (float)SWING : (steps < -(float)SWING) ? -(float)SWING : steps;
    DAC_DHR12R1 = (uint32_t)(MIDDLE + (int32_t)(within + ((within < 0.0F) ? -0.5F : 0.5F)));
}

void drive_off(void)
{
    GPIOB_BSRR = 0x10000U << ENABLE;
    convert(0.0F);
}

void period(void)
{
    static forcefeel_input in = { .stiffness_factor = 1.0F };
    const uint32_t begin = TIM2_CNT;
    TIM2_SR = 0U;
    convert(command); /* of the last sample, whose delay is a period */
    in.late = late;
    read_inputs(&in);
    const uint32_t status
        = forcefeel_step(&axis, BOARD_SETTINGS, sizeof BOARD_SETTINGS / sizeof *BOARD_SETTINGS, &in, &board_output);
    command = board_output.command;
    if (board_output.enable != 0U) {
        GPIOB_BSRR = 1U << ENABLE;
    } else {
        drive_off();
    }
    check_stack();
    if (status == FORCEFEEL_OK) {
        IWDG_KR = 0xAAAAU;
    }
    if (((periods % TELEMETRY_EVERY) == 0U) && (is_pending == 0U)) {
        const forcefeel_output *const o = &board_output;
        pending = (frame) { periods, o->command, o->torque, o->feel[0], o->feel[1], o->acting, o->tripped, (uint16_t)stack_free,
            (uint16_t)(longest / (PERIOD_TICKS / 1000U)), (uint8_t)o->state, (uint8_t)o->enable, (uint8_t)status,
            (uint8_t)((late > 255U) ? 255U : late) };
        BARRIER();
        is_pending = 1U;
    }
    ++periods;
    late = ((TIM2_SR & 1U) != 0U) ? late + 1U : 0U;
    const uint32_t took = (late != 0U) ? PERIOD_TICKS : TIM2_CNT - begin;
    longest = (took > longest) ? took : longest;
}

static void send(uint8_t byte)
{
    while ((USART1_SR & 0x80U) == 0U) {
    }
    USART1_DR = byte;
}

/* Consistent overhead byte stuffing: no zero within a frame, one behind it. */
static void send_frame(const uint8_t *bytes, uint32_t count)
{
    for (uint32_t at = 0U; at <= count;) {
        uint32_t stop = at;
        while ((stop < count) && (bytes[stop] != 0U)) {
            ++stop;
        }
        send((uint8_t)(stop - at + 1U));
        for (; at < stop; ++at) {
            send(bytes[at]);
        }
        ++at;
    }
    send(0U);
}

static void outputs_begin(void)
{
    RCC_AHB1ENR = 0x3U; /* GPIOA, GPIOB */
    RCC_APB1ENR = 0x20000001U; /* TIM2, DAC */
    RCC_APB2ENR = 0x110U; /* USART1, ADC1 */
    (void)RCC_APB2ENR; /* the clocks run two cycles later */
    DAC_CR = 3U; /* without its buffer, which does not reach the ends */
    drive_off();
    GPIOB_MODER = (GPIOB_MODER & ~0x3U) | 0x1U; /* PB0 out */
    GPIOA_MODER = (GPIOA_MODER & ~0xC0FFFU) | 0x80FFFU; /* PA0 to PA5 analog, PA9 USART1 */
    GPIOA_AFRH = (GPIOA_AFRH & ~0xF0U) | 0x70U;
    USART1_BRR = APB2_HZ / BAUD;
    USART1_CR1 = 0x2008U; /* on, sends */
}

static void watchdog_begin(void)
{
    IWDG_KR = 0xCCCCU;
    IWDG_KR = 0x5555U;
    IWDG_PR = 0U; /* four clocks a count */
    IWDG_RLR = WATCHDOG_COUNTS;
    IWDG_KR = 0xAAAAU;
}

static void timer_begin(void)
{
    TIM2_PSC = 0U;
    TIM2_ARR = PERIOD_TICKS - 1U;
    TIM2_SR = 0U;
    TIM2_CR2 = 0x20U; /* its update starts the converter */
    TIM2_DIER = 1U;
    NVIC_ISER0 = 1U << 28;
    TIM2_CR1 = 1U;
}

int main(void)
{
    outputs_begin();
    clock_begin();
    inputs_begin();
    if (forcefeel_init(&axis, sizeof axis, &BOARD_LOADER, BOARD_SETTINGS, sizeof BOARD_SETTINGS / sizeof *BOARD_SETTINGS)
        != FORCEFEEL_OK) {
        fault();
    }
    stack_free = stack_never_used();
    watchdog_begin();
    timer_begin();
    for (;;) {
        __asm volatile("wfi");
        if (is_pending != 0U) {
            BARRIER();
            send_frame((const uint8_t *)&pending, sizeof pending);
            if ((pending.period % 1024U) == 0U) {
                stack_free = stack_never_used();
            }
            BARRIER();
            is_pending = 0U;
        }
    }
}
