/* Logger of FMI 2.0: its message is a format string, followed by arguments. */
#include <stdarg.h>
#include <stdio.h>

void fmu_participant_logged(void *environment, int status, const char *text);

void fmu_participant_log(void *environment, const char *instance, int status, const char *category,
                         const char *message, ...) {
    char text[4096] = "";
    va_list arguments;
    (void)instance;
    (void)category;
    if (message) {
        va_start(arguments, message);
        vsnprintf(text, sizeof text, message, arguments);
        va_end(arguments);
    }
    fmu_participant_logged(environment, status, text);
}
