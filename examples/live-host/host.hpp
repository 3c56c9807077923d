// A host in C++, header only: the packet of docs/reference/host.md.
//
//     forcefeel::FromHost values;
//     values.dynamic_pressure = 1500.0f;
//     const auto packet = forcefeel::encode(sequence, forcefeel::ACTIVE | forcefeel::FLIGHT, values);
//
// Numbers are little-endian IEEE 754 single precision, as on every common target. C++17; nothing but the standard library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace forcefeel {

enum Switch : std::uint32_t {
    ACTIVE = 1,
    AUTOPILOT = 1u << 1,
    PUSHER = 1u << 2,
    JAM = 1u << 3,
    DISCONNECT = 1u << 4,
    POWER_LOST = 1u << 5,
    TRIM_RUNAWAY = 1u << 6,
    FREEZE = 1u << 7,
    FLIGHT = 1u << 8,
};

// What a host sends, in SI units; the defaults are what holds without a host.
struct FromHost {
    float dynamic_pressure = 0.0f;
    float spring_factor = 1.0f;
    float trim = 0.0f;
    float autopilot_position = 0.0f;
    float autopilot_force = 0.0f;
    float added_force = 0.0f;
    float shaker = 0.0f;
    float pusher_force = 0.0f;
    float trim_runaway_rate = 0.0f;
    float jam_force = 0.0f;
    float added_stiffness = 0.0f;
    float added_damping = 0.0f;
    float true_airspeed = 0.0f;
    float angle_of_attack = 0.0f;
    float sideslip = 0.0f;
    float roll_rate = 0.0f;
    float pitch_rate = 0.0f;
    float yaw_rate = 0.0f;
    float load_factor = 1.0f;
    float mach = 0.0f;
    float tab = 0.0f;
    float flap = 0.0f;
};

constexpr std::size_t NUMBERS = sizeof(FromHost) / sizeof(float);
constexpr std::size_t BYTES = 16 + 4 * NUMBERS;
static_assert(NUMBERS == 22, "the numbers of FFH2, in their order");

inline std::uint32_t crc32(const std::uint8_t *bytes, std::size_t count) {
    std::uint32_t sum = 0xFFFFFFFFu;
    for (std::size_t k = 0; k < count; k++) {
        sum ^= bytes[k];
        for (int bit = 0; bit < 8; bit++) sum = (sum & 1) != 0 ? (sum >> 1) ^ 0xEDB88320u : sum >> 1;
    }
    return ~sum;
}

inline std::array<std::uint8_t, BYTES> encode(std::uint32_t sequence, std::uint32_t switches, const FromHost &values) {
    std::array<std::uint8_t, BYTES> packet{};
    const auto word = [&packet](std::size_t at, std::uint32_t value) {
        for (std::size_t k = 0; k < 4; k++) packet[at + k] = static_cast<std::uint8_t>(value >> (8 * k));
    };
    std::memcpy(packet.data(), "FFH2", 4);
    word(4, sequence);
    word(8, switches);
    std::array<std::uint32_t, NUMBERS> bits{};
    std::memcpy(bits.data(), &values, sizeof(values));
    for (std::size_t k = 0; k < NUMBERS; k++) word(12 + 4 * k, bits[k]);
    word(BYTES - 4, crc32(packet.data(), BYTES - 4));
    return packet;
}

}  // namespace forcefeel
