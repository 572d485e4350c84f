import { Center, Loader } from "@mantine/core";
import { type ComponentType, lazy, Suspense } from "react";
import { Redirect, Route, Switch } from "wouter";
import { OtherFamily } from "./lib/OtherFamily";
import { insteadOf, PAGES, type PageEntry } from "./shell/pages";
import { Shell } from "./shell/Shell";

const Recordings = lazy(() => import("./pages/recordings/RecordingsPage"));
const COMPONENTS: Record<string, ComponentType> = {
  "/": lazy(() => import("./pages/bench/BenchPage")),
  "/registers": lazy(() => import("./pages/registers/RegistersPage")),
  "/ramps": lazy(() => import("./pages/ramps/RampsPage")),
  "/sramp": lazy(() => import("./pages/sramp/SRampPage")),
  "/sixpoint": lazy(() => import("./pages/sixpoint/SixPointPage")),
  "/closed-loop": lazy(() => import("./pages/closedloop/ClosedLoopPage")),
  "/filters": lazy(() => import("./pages/filters/FiltersPage")),
  "/microsteps": lazy(() => import("./pages/microsteps/MicrostepsPage")),
  "/chain": lazy(() => import("./pages/chain/ChainPage")),
  "/parameters": lazy(() => import("./pages/parameters/ParametersPage")),
  "/encoder": lazy(() => import("./pages/encoder/EncoderPage")),
  "/stallguard": lazy(() => import("./pages/stallguard/StallGuardPage")),
  "/currents": lazy(() => import("./pages/currents/CurrentsPage")),
  "/rotary": lazy(() => import("./pages/rotary/RotaryPage")),
  "/twin": lazy(() => import("./pages/twin/TwinPage")),
  "/audit": lazy(() => import("./pages/audit/AuditPage")),
  "/recordings": Recordings,
  "/profiles": lazy(() => import("./pages/profiles/ProfilesPage")),
  "/console": lazy(() => import("./pages/console/ConsolePage")),
  "/connections": lazy(() => import("./pages/connections/ConnectionsPage")),
};
const PlotSpeed = lazy(() => import("./pages/speed/PlotSpeedPage"));

export function App() {
  return (
    <Shell>
      <Suspense
        fallback={
          <Center h="60vh">
            <Loader aria-label="Loading the page" />
          </Center>
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
    <OtherFamily page={entry.label} families={entry.families} instead={(family) => insteadOf(entry, family)}>
      <Page />
    </OtherFamily>
  );
}
