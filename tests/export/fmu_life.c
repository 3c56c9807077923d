/* Makes, runs and frees an FMU over and over, as FMI 2.0 and as FMI 3.0: for valgrind, which finds what is not given back.

   fmu_life LIBRARY RESOURCES TOKEN TIMES */
#include <dlfcn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef void *Any;
typedef struct {
    void (*logger)(Any, const char *, int, const char *, const char *, ...);
    Any allocate, release, finished, environment;
} Callbacks;

static int failures;

static void told2(Any e, const char *n, int s, const char *c, const char *message, ...)
{
    (void)e, (void)n, (void)s, (void)c, (void)message;
}

static void told3(Any e, int s, const char *c, const char *message)
{
    (void)e, (void)s, (void)c, (void)message;
}

static void must(int status, const char *what)
{
    if (status != 0) {
        failures++;
        fprintf(stderr, "%s: %d\n", what, status);
    }
}

static void refused(int status, const char *what)
{
    if (status != 3) {
        failures++;
        fprintf(stderr, "%s: expected an error, got %d\n", what, status);
    }
}

/* C has no cast from what dlsym gives to a function; POSIX asks for this one. */
#define FIND(type, name, ...) type (*name)(__VA_ARGS__); *(Any *)&name = dlsym(library, #name)

int main(int count, char **words)
{
    Any library = count == 5 ? dlopen(words[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    if (library == NULL) {
        fprintf(stderr, "%s\n", dlerror());
        return 2;
    }
    FIND(Any, fmi2Instantiate, const char *, int, const char *, const char *, const Callbacks *, int, int);
    FIND(void, fmi2FreeInstance, Any);
    FIND(int, fmi2SetupExperiment, Any, int, double, double, int, double);
    FIND(int, fmi2ExitInitializationMode, Any);
    FIND(int, fmi2SetReal, Any, const unsigned *, size_t, const double *);
    FIND(int, fmi2GetReal, Any, const unsigned *, size_t, double *);
    FIND(int, fmi2DoStep, Any, double, double, int);
    FIND(int, fmi2GetFMUstate, Any, Any *);
    FIND(int, fmi2SetFMUstate, Any, Any);
    FIND(int, fmi2FreeFMUstate, Any, Any *);
    FIND(int, fmi2GetDirectionalDerivative, Any, const unsigned *, size_t, const unsigned *, size_t, const double *, double *);
    FIND(int, fmi2Reset, Any);
    FIND(Any, fmi3InstantiateCoSimulation, const char *, const char *, const char *, bool, bool, bool, bool, const uint32_t *, size_t,
         Any, void (*)(Any, int, const char *, const char *), Any);
    FIND(void, fmi3FreeInstance, Any);
    FIND(int, fmi3EnterInitializationMode, Any, bool, double, double, bool, double);
    FIND(int, fmi3ExitInitializationMode, Any);
    FIND(int, fmi3DoStep, Any, double, double, bool, bool *, bool *, bool *, double *);
    FIND(int, fmi3GetFMUState, Any, Any *);
    FIND(int, fmi3FreeFMUState, Any, Any *);
    FIND(int, fmi3SerializedFMUStateSize, Any, Any, size_t *);
    FIND(int, fmi3SerializeFMUState, Any, Any, uint8_t *, size_t);
    FIND(int, fmi3DeserializeFMUState, Any, const uint8_t *, size_t, Any *);
    const Callbacks callbacks = {told2, NULL, NULL, NULL, NULL};
    const unsigned force = 1, angle = 101;
    const double push = 40.0, one = 1.0;
    char uri[4096];
    snprintf(uri, sizeof uri, "file://%s", words[2]);
    for (int time = 0; time < atoi(words[4]); time++) {
        double found = 0.0;
        Any it = fmi2Instantiate("one", 1, words[3], uri, &callbacks, 0, 0), state = NULL, other = NULL;
        if (it == NULL)
            return 3;
        must(fmi2SetupExperiment(it, 0, 0, 0, 0, 0), "setup");
        must(fmi2ExitInitializationMode(it), "initialize");
        must(fmi2SetReal(it, &force, 1, &push), "set");
        must(fmi2DoStep(it, 0, 0.001, 0), "step");
        must(fmi2GetReal(it, &angle, 1, &found), "get");
        must(fmi2GetFMUstate(it, &state), "keep");
        must(fmi2GetFMUstate(it, &state), "keep again");
        must(fmi2SetFMUstate(it, state), "restore");
        must(fmi2FreeFMUstate(it, &state), "free state");
        must(fmi2GetDirectionalDerivative(it, &angle, 1, &force, 1, &one, &found), "derivative");
        refused(fmi2DoStep(it, 0, 0.0007, 0), "step of no multiple");
        refused(fmi2GetReal(it, NULL, 1, &found), "null");
        refused(fmi2GetReal(NULL, &angle, 1, &found), "no instance");
        must(fmi2Reset(it), "reset");
        fmi2FreeInstance(it);
        fmi2FreeInstance(NULL);
        if (fmi2Instantiate("one", 1, "another", uri, &callbacks, 0, 0) != NULL || fmi2Instantiate(NULL, 1, NULL, NULL, NULL, 0, 0) != NULL)
            return 4;

        it = fmi3InstantiateCoSimulation("one", words[3], words[2], false, false, false, false, NULL, 0, NULL, told3, NULL);
        if (it == NULL)
            return 5;
        bool event, end, early;
        double last;
        size_t size;
        must(fmi3EnterInitializationMode(it, false, 0, 0, false, 0), "enter");
        must(fmi3ExitInitializationMode(it), "initialize");
        must(fmi3DoStep(it, 0, 0.001, false, &event, &end, &early, &last), "step");
        refused(fmi3DoStep(it, last, 0.001, false, NULL, &end, &early, &last), "null");
        must(fmi3GetFMUState(it, &state), "keep");
        must(fmi3SerializedFMUStateSize(it, state, &size), "size");
        uint8_t *bytes = malloc(size);
        must(fmi3SerializeFMUState(it, state, bytes, size), "write");
        refused(fmi3SerializeFMUState(it, state, bytes, size - 1), "too little room");
        must(fmi3DeserializeFMUState(it, bytes, size, &other), "read");
        free(bytes);
        must(fmi3FreeFMUState(it, &state), "free state");
        must(fmi3FreeFMUState(it, &other), "free state");
        fmi3FreeInstance(it);
    }
    dlclose(library);
    return failures != 0;
}
