"""Somebody else's master of FMUs, ecos: ``python ecos.py FMU STEPS KEY=VALUE...`` prints the column's angle after each millisecond.

A process of its own, since ecos speaks to the terminal by itself.
"""

import sys

from ecospy import EcosSimulation, EcosSimulationStructure

STEP_S = 1e-3


def number(text):
    return int(text) if text.isdigit() else float(text)


def main(fmu, steps, *given):
    """Runs an FMU."""
    start = {f"it::{key}": number(value) for key, _, value in (one.partition("=") for one in given)}
    with EcosSimulationStructure() as structure:
        structure.add_model("it", fmu)
        structure.add_parameter_set("start", start)
        with EcosSimulation(structure=structure, step_size=STEP_S) as simulation:
            simulation.init(parameter_set="start")
            for _ in range(int(steps)):
                simulation.step()
                print("angle", simulation.get_real("it::column_angle").hex())
            simulation.terminate()


if __name__ == "__main__":
    main(*sys.argv[1:])
