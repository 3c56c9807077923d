/* An importer of FMI 2.0 on Windows: a step of pilot force, and the column's angle after each communication step, exactly.

   fmu_step.exe LIBRARY RESOURCES-URI TOKEN FORCE-REFERENCE FORCE ANGLE-REFERENCE STEPS STEP */
#include <stdio.h>
#include <stdlib.h>
#include <windows.h>

typedef void *Any;
typedef struct {
    void (*logger)(Any, const char *, int, const char *, const char *, ...);
    Any allocate, release, finished, environment;
} Callbacks;

static void told(Any e, const char *name, int status, const char *category, const char *message, ...)
{
    (void)e, (void)name, (void)status, (void)category;
    fprintf(stderr, "%s\n", message);
}

#define FIND(type, name, ...) type (*name)(__VA_ARGS__) = (type (*)(__VA_ARGS__))(Any)GetProcAddress(library, #name)

int main(int count, char **words)
{
    HMODULE library = count == 9 ? LoadLibraryA(words[1]) : NULL;
    if (library == NULL) {
        fprintf(stderr, "cannot be loaded: %lu\n", GetLastError());
        return 2;
    }
    FIND(Any, fmi2Instantiate, const char *, int, const char *, const char *, const Callbacks *, int, int);
    FIND(int, fmi2SetupExperiment, Any, int, double, double, int, double);
    FIND(int, fmi2EnterInitializationMode, Any);
    FIND(int, fmi2ExitInitializationMode, Any);
    FIND(int, fmi2SetReal, Any, const unsigned *, size_t, const double *);
    FIND(int, fmi2GetReal, Any, const unsigned *, size_t, double *);
    FIND(int, fmi2DoStep, Any, double, double, int);
    FIND(int, fmi2Terminate, Any);
    FIND(void, fmi2FreeInstance, Any);
    const Callbacks callbacks = {told, NULL, NULL, NULL, NULL};
    const unsigned force_at = atoi(words[4]), angle_at = atoi(words[6]);
    const double force = atof(words[5]), step = atof(words[8]);
    double angle = 0.0;
    Any fmu = fmi2Instantiate("windows", 1, words[3], words[2], &callbacks, 0, 0);
    if (fmu == NULL)
        return 3;
    int status = fmi2SetupExperiment(fmu, 0, 0.0, 0.0, 0, 0.0);
    status |= fmi2EnterInitializationMode(fmu) | fmi2SetReal(fmu, &force_at, 1, &force) | fmi2ExitInitializationMode(fmu);
    for (int k = 0; k < atoi(words[7]); k++) {
        status |= fmi2DoStep(fmu, k * step, step, 1) | fmi2GetReal(fmu, &angle_at, 1, &angle);
        printf("%a\n", angle);
    }
    status |= fmi2Terminate(fmu);
    fmi2FreeInstance(fmu);
    return status;
}
