// The page: connects its controls, and opens the sample or the clip that its address names.

import { listenToChecks } from "./checks";
import { listenToChoices } from "./choices";
import { listenToDownloads } from "./downloads";
import { listenToIntroduction } from "./introduction";
import { listenToKeys } from "./keys";
import { listenToLook } from "./look";
import { listenToRuns } from "./runs";
import { listenToSources, openFirst } from "./sources";
import { listenToThrough } from "./through";
import { listenToTransport } from "./transport";
import { listenToUp } from "./up";

listenToIntroduction();
listenToSources();
listenToChoices();
listenToRuns();
listenToChecks();
listenToLook();
listenToUp();
listenToThrough();
listenToTransport();
listenToDownloads();
listenToKeys();
openFirst();
