/* Random bytes for Rust's hash maps, which Windows 10 has and Wine before 9 has not. None of the numbers of an FMU depends on them. */
#include <stddef.h>

__declspec(dllexport) int ProcessPrng(unsigned char *bytes, size_t count)
{
    for (size_t k = 0; k < count; k++)
        bytes[k] = (unsigned char)(37 * k + 11);
    return 1;
}
