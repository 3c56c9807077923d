"""An exported FMU in the hands of FMPy, by names of variables."""

from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave, fmi3LogMessageCallback

STEP_S = 5e-4


class Imported:
    """An instance, in initialization mode until ``begin``; what its logger was told is in ``messages``."""

    def __init__(self, unzipped, *, token=None, events=False):
        self.about = fmpy.read_model_description(str(unzipped))
        self.two = self.about.fmiVersion == "2.0"
        self.variables = {it.name: it for it in self.about.modelVariables}
        self.messages = []
        given = {
            "guid": token or self.about.guid,
            "unzipDirectory": str(unzipped),
            "modelIdentifier": self.about.coSimulation.modelIdentifier,
            "instanceName": "one",
        }
        if self.two:
            self.fmu = FMU2Slave(**given)
            self._callbacks = fmi2CallbackFunctions()
            self._callbacks.logger = fmi2CallbackLoggerTYPE(lambda *it: self.messages.append(it[-1].decode()))
            self.fmu.instantiate(callbacks=self._callbacks)
            self.fmu.setupExperiment(startTime=0.0)
            self.fmu.enterInitializationMode()
        else:
            self.fmu = FMU3Slave(**given)
            self._logger = fmi3LogMessageCallback(lambda *it: self.messages.append(it[-1].decode()))
            self.fmu.instantiate(eventModeUsed=events, logMessage=self._logger)
            self.fmu.enterInitializationMode()
        self.time = 0.0
        self.steps = 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.fmu.freeInstance()

    def begin(self, **values):
        self.set(**values)
        self.fmu.exitInitializationMode()
        return self

    def set(self, **values):
        for name, value in values.items():
            it = self.variables[name.replace("__", ".")]
            verb = {"Real": "setReal", "Integer": "setInteger", "Float64": "setFloat64", "Int32": "setInt32"}
            getattr(self.fmu, verb.get(it.type, "setBoolean"))([it.valueReference], [value])

    def get(self, *names):
        references = [self.variables[name].valueReference for name in names]
        return (self.fmu.getReal if self.two else self.fmu.getFloat64)(references)

    def step(self, by=STEP_S):
        self.fmu.doStep(currentCommunicationPoint=self.time, communicationStepSize=by)
        self.steps += round(by / STEP_S)
        self.time = self.steps * STEP_S

    def derivative(self, unknown, known):
        of = ([self.variables[unknown].valueReference], [self.variables[known].valueReference], [1.0])
        return self.fmu.getDirectionalDerivative(*of)[0]


def unzipped(fmus: Path, name: str) -> Path:
    """Where FMPy finds the FMU of this name."""
    folder = fmus / name
    if not folder.exists():
        fmpy.extract(str(fmus / f"{name}.fmu"), str(folder))
    return folder
