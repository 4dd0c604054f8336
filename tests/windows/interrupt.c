/* Starts a program and presses Ctrl-C once the program has written a file. Usage: interrupt FILE PROGRAM [ARGUMENTS]...
 * Returns the program's exit status. */
#include <stdio.h>
#include <wchar.h>
#include <windows.h>

/* Milliseconds in which the file must appear, and the program must end. */
#define PATIENCE 60000

static BOOL WINAPI stay(DWORD event) {
    (void)event;
    return TRUE;
}

/* The command line of this program without its first two words. */
static wchar_t *rest(wchar_t *line) {
    int word, quoted = 0;
    for (word = 0; word < 2; line++) {
        quoted ^= *line == L'"';
        if (*line == L' ' && !quoted) {
            word++;
        }
    }
    return line;
}

static int fail(const char *what) {
    printf("%s: error %lu\n", what, GetLastError());
    return 100;
}

int wmain(int argc, wchar_t **argv) {
    STARTUPINFOW startup;
    PROCESS_INFORMATION process;
    DWORD status, waited;
    if (argc < 3) {
        return 100;
    }
    ZeroMemory(&startup, sizeof startup);
    startup.cb = sizeof startup;
    /* The key reaches all programs of a console. There may be none yet. */
    AllocConsole();
    SetConsoleCtrlHandler(NULL, FALSE);
    if (!CreateProcessW(NULL, rest(GetCommandLineW()), NULL, NULL, FALSE, 0, NULL, NULL, &startup, &process)) {
        return fail("CreateProcess");
    }
    SetConsoleCtrlHandler(stay, TRUE);
    for (waited = 0; GetFileAttributesW(argv[1]) == INVALID_FILE_ATTRIBUTES; waited += 10) {
        if (waited > PATIENCE || WaitForSingleObject(process.hProcess, 10) != WAIT_TIMEOUT) {
            return fail("the file has not appeared");
        }
    }
    if (!GenerateConsoleCtrlEvent(CTRL_C_EVENT, 0)) {
        return fail("GenerateConsoleCtrlEvent");
    }
    if (WaitForSingleObject(process.hProcess, PATIENCE) != WAIT_OBJECT_0) {
        TerminateProcess(process.hProcess, 99);
        return fail("the program goes on");
    }
    GetExitCodeProcess(process.hProcess, &status);
    return (int)status;
}
