"""What each figure is about, in a sentence or two; no numbers, because those come from the design."""

MEANINGS = {
    "figure-02": "Flow through the control valve against load pressure, eq. (1), for five valve currents. The dashed line is"
    " the tangent at a fifth of the rated current and a third of the supply pressure, where the report takes the gains of"
    " eq. (2).",
    "figure-08": "From the amplifier's input to the position of the piston and of the column, both in volts of the"
    " potentiometer. Where the compliant curves differ from the rigid one, the column oscillates on its linkage.",
    "figure-09": "The same with the position loop closed. An ideal servo stays at 0 dB well beyond the frequencies of the feel.",
    "figure-10": "From the torque input of the feel computer through servo and load cell back to it. The closed loop is at the"
    " boundary of stability if the gain is 0 dB at a phase of −180°.",
    "figure-11a": "The original system with a rigid link after a step of pilot force. Both settings are programmed for the"
    " same deflection, frequency and damping ratio.",
    "figure-11b": "The original system with its compliant link after the same step.",
    "figure-14": "Rigid, compliant and compensated loader beside the ideal feel, after a step of pilot force, with the demand on"
    " the valve.",
    "step": "The motor by current alone, with a rigid and with a compliant link, beside the ideal feel and the law; below, the "
    "current and the voltage, for the law its command.",
    "hand": "Relative to the programmed deflection at rest: 0 dB is correct there. Without current the hand moves rotor and "
    "column; "
    "a difference from the ideal curve is the feel of the machine.",
    "command-to-force": "Relative to the motor's own force: at 0 dB all of it reaches the load cell. Column held: a firm hand, "
    "against which the rotor oscillates on the link.",
    "command-to-position": "Relative to the deflection of the programmed spring by the motor's torque. Where the curves of motor "
    "and column separate, the two oscillate against each other on the link.",
    "loop": "Spring and damper by the motor's current at its own position. The closed loop is at the boundary of stability if "
    "the gain is 0 dB at a phase of −180°.",
}
"""By the figure's key."""
