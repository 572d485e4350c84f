import { type ComponentType, Suspense } from "react";
import { Redirect, Route, Switch } from "wouter";
import type { PageEntry } from "./families/family";
import { Loading } from "./lib/Loading";
import { lazily } from "./lib/later";
import BenchPage from "./pages/bench/BenchPage";
import { OtherDevice } from "./shell/OtherDevice";
import { FAMILY_PAGES, PAGES } from "./shell/pages";
import { Shell } from "./shell/Shell";

const page = (load: () => Promise<{ default: ComponentType }>) => lazily(async () => (await load()).default);

const Recordings = page(() => import("./pages/recordings/RecordingsPage"));
const COMPONENTS: Record<string, ComponentType> = {
  "/": BenchPage, // where most begin: in one file with the shell it packs better than in dozens that others share
  "/first-run": page(() => import("./pages/firstRun/FirstRunPage")),
  "/registers": page(() => import("./pages/registers/RegistersPage")),
  "/microsteps": page(() => import("./pages/microsteps/MicrostepsPage")),
  "/encoder": page(() => import("./pages/encoder/EncoderPage")),
  "/stallguard": page(() => import("./pages/stallguard/StallGuardPage")),
  "/program": page(() => import("./pages/program/ProgramPage")),
  "/rotary": page(() => import("./pages/rotary/RotaryPage")),
  "/tune": page(() => import("./pages/tune/TunePage")),
  "/together": page(() => import("./pages/together/TogetherPage")),
  "/twin": page(() => import("./pages/twin/TwinPage")),
  "/health": page(() => import("./pages/health/HealthPage")),
  "/audit": page(() => import("./pages/audit/AuditPage")),
  "/recordings": Recordings,
  "/profiles": page(() => import("./pages/profiles/ProfilesPage")),
  "/console": page(() => import("./pages/console/ConsolePage")),
  "/connections": page(() => import("./pages/connections/ConnectionsPage")),
  ...Object.fromEntries(FAMILY_PAGES.map(({ path, load }) => [path, page(load)])),
};
const PlotSpeed = page(() => import("./pages/speed/PlotSpeedPage"));

export function App() {
  return (
    <Shell>
      <Suspense
        fallback={
          <div className="row" style={{ height: "60vh", justifyContent: "center" }}>
            <Loading label="Loading the page" />
          </div>
        }
      >
        <Switch>
          {PAGES.map((entry) => (
            <Route key={entry.path} path={entry.path}>
              <Entry entry={entry} />
            </Route>
          ))}
          <Route path="/recordings/*" component={Recordings} />
          <Route path="/bench/plots" component={PlotSpeed} />
          <Route>
            <Redirect to="/" replace />
          </Route>
        </Switch>
      </Suspense>
    </Shell>
  );
}

function Entry({ entry }: { entry: PageEntry }) {
  const Page = COMPONENTS[entry.path];
  if (Page === undefined) return null;
  return (
    <OtherDevice entry={entry}>
      <Page />
    </OtherDevice>
  );
}
