"""Ten things in a row, from a model to a saved loader: run it with ``python examples/ten_things.py``.

Numbers inside are SI; text such as "7000 lb/in" has its unit.
"""

import math
from pathlib import Path
from tempfile import TemporaryDirectory

import control
import numpy as np
import pandas as pd

import forcefeel as ff


def main() -> None:
    """Prints what each step finds."""
    # 1 A loader: the machine of the 1974 report under a controller of today, its link a little stiffer.
    loader = ff.digital_elevator().replace({"linkage.stiffness": "7000 lb/in"})
    print(loader)

    # 2 A model: a control.StateSpace of the loader with the report's analog loop.
    model = ff.compliant_model(loader)
    print(f"{model.nstates} states, from {model.input_labels} to {len(model.output_labels)} outputs")

    # 3 Its poles.
    for mode in ff.modes(model):
        if mode.imaginary_per_s > 0:
            print(f"  {mode.frequency_rad_per_s / (2 * math.pi):6.2f} Hz, damping ratio {mode.damping_ratio:.3f}")

    # 4 Bode: python-control's functions take the model as it is; loader.plot_bode() draws it beside the programmed feel.
    gain = control.frequency_response(model[0, 0], 2 * np.pi * np.array([0.1, 2.0, 11.4])).magnitude
    print("column angle per pilot force, deg/N, at 0.1, 2 and 11.4 Hz:", np.degrees(gain).round(4))

    # 5 A step of force: 100 N on the linear model, an xarray.Dataset.
    step = ff.step_response(model, force_n=100.0)
    print(f"the column ends at {math.degrees(step.column_angle_rad[-1]):.2f} deg")

    # 6 A force of your own, through the nonlinear machine under a law of today.
    time = np.linspace(0.0, 2.0, 2001)
    force = ff.Recorded(time, 80.0 * np.sin(2 * np.pi * 0.8 * time) ** 3)
    run = ff.simulate(loader, ff.Scenario(force), "robust")
    print(run)  # run.plot() draws it

    # 7 Machines within tolerance, as a pandas table.
    machines = ff.run_sweep(ff.Sweep(loader, ff.Scenario(ff.Step(100.0, start_s=0.1)), "robust", runs=64))
    table: pd.DataFrame = machines.runs.to_dataframe()
    print(np.degrees(table["final_angle_rad"]).describe()[["mean", "std", "min", "max"]].round(3).to_string())

    # 8 A law, saved and read again.
    law = ff.Law.of("robust", loader)
    with TemporaryDirectory() as folder:
        saved = Path(folder, "law.json")
        law.save(saved)
        print(f"law {ff.Law.of(saved, loader).name}, every {1e3 * loader['controller.period']:g} ms")

        # 9 Does the loader qualify with it? One test here; without ``tests`` it is the whole programme.
        setup = ff.qualification.QualificationSetup(laws=("robust",), tests=("release-25-positive",))
        print(f"release from a quarter of the throw passed: {ff.qualify_loader(loader, setup).fulfilled}")

        # 10 Save the loader as a file and load it.
        file = Path(folder, "my-loader.toml")
        file.write_text(loader.to_toml(), encoding="utf-8")
        again = ff.load(file)
        print(f"{again['linkage.stiffness']:.0f} N/m in the file, {loader['linkage.stiffness']:.0f} N/m here")


if __name__ == "__main__":
    main()
