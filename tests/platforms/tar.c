/* The tar that Windows has and Wine does not, as ecos calls it: tar -xf FMU -C FOLDER. Copies what the test has unpacked, in UNPACKED. */
#include <stdio.h>
#include <stdlib.h>

int main(int count, char **words)
{
    char command[2048];
    snprintf(command, sizeof command, "xcopy /E /I /Q \"%s\" \"%s\"", getenv("UNPACKED"), words[count - 1]);
    return system(command);
}
