/* An FMU in ecos, a foreign importer, on Windows: prints the column's angle after each communication step under a constant pilot force.

   ecos_step.exe LIBECOSC.DLL FMU FORCE STEPS STEP */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <windows.h>

typedef void *Any;

#define FIND(type, name, ...) type (*name)(__VA_ARGS__) = (type (*)(__VA_ARGS__))(Any)GetProcAddress(library, "ecos_" #name)

int main(int count, char **words)
{
    HMODULE library = count == 6 ? LoadLibraryA(words[1]) : NULL;
    if (library == NULL) {
        fprintf(stderr, "ecos cannot be loaded: %lu\n", GetLastError());
        return 2;
    }
    FIND(const char *, last_error_msg, void);
    FIND(Any, simulation_structure_create, void);
    FIND(bool, simulation_structure_add_model, Any, const char *, const char *, double);
    FIND(bool, simulation_structure_add_parameter_set, Any, const char *, Any);
    FIND(Any, parameter_set_create, void);
    FIND(void, parameter_set_add_real, Any, const char *, double);
    FIND(Any, simulation_create_from_structure, Any, double);
    FIND(bool, simulation_init, Any, double, const char *);
    FIND(double, simulation_step, Any, size_t);
    FIND(bool, simulation_get_real, Any, const char *, double *);
    FIND(void, simulation_terminate, Any);
    const Any structure = simulation_structure_create(), start = parameter_set_create();
    Any simulation = NULL;
    double angle = 0.0;
    parameter_set_add_real(start, "loader::pilot_force", atof(words[3]));
    bool good = simulation_structure_add_model(structure, "loader", words[2], -1.0)
        && simulation_structure_add_parameter_set(structure, "start", start)
        && (simulation = simulation_create_from_structure(structure, atof(words[5]))) != NULL
        && simulation_init(simulation, 0.0, "start");
    for (int k = 0; good && k < atoi(words[4]); k++) {
        (void)simulation_step(simulation, 1);
        good = simulation_get_real(simulation, "loader::column_angle", &angle);
        printf("angle %a\n", angle);
    }
    if (!good) {
        fprintf(stderr, "ecos: %s\n", last_error_msg());
        return 1;
    }
    simulation_terminate(simulation);
    fflush(stdout);
    return 0;
}
