"""What each figure is about, in a sentence or two; no numbers, because those come from the design."""

MEANINGS = {
    "figure-02": "Flow through the control valve against load pressure, eq. (1), for five valve currents. The dashed line is"
    " the tangent at a fifth of the rated current and a third of the supply pressure, where the report takes the gains of"
    " eq. (2).",
    "figure-08": "From the amplifier's input to the position of the piston and of the column, both in volts of the"
    " potentiometer. Where the compliant curves leave the rigid one, the column swings on its linkage.",
    "figure-09": "The same with the position loop closed. A servo that the pilot cannot feel would hold 0 dB well beyond the"
    " frequencies of the feel.",
    "figure-10": "From the torque that the feel computer sees, through servo and load cell, back to it. The closed loop is at"
    " the edge of stability where the gain is 0 dB while the phase is −180°.",
    "figure-11a": "The original system after a step of pilot force, had it a rigid link. Both settings are programmed for the"
    " same deflection, frequency and damping ratio.",
    "figure-11b": "The original system with its real, compliant link, after the same step.",
    "figure-14": "Rigid, compliant and compensated loader beside the ideal feel, after a step of pilot force, and what the"
    " valve must give for it.",
    "step": "The motor by current alone, with a rigid link and with the real one, beside the ideal feel and the law's; below, what "
    "current and voltage are asked for, of the law its command.",
    "hand": "Over the programmed deflection at rest, so that 0 dB is right there. With no current the hand moves rotor and column; "
    "where the curves leave the ideal one the hand feels the machine.",
    "command-to-force": "Over the motor's own force, so that at 0 dB all of it arrives at the load cell. Column held: a firm hand, "
    "against which the rotor swings on the link.",
    "command-to-position": "Over what the motor's torque deflects the programmed spring by: at 0 dB the two are equal. Where motor "
    "and column part, they swing against one another on the link.",
    "loop": "Spring and damper by the motor's current at its own position. The closed loop is at the edge of stability where the "
    "gain is 0 dB while the phase is −180°.",
}
"""By the figure's key."""
