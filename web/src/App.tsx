import { Center, Loader } from "@mantine/core";
import { lazy, Suspense } from "react";
import { Redirect, Route, Switch } from "wouter";
import { Shell } from "./shell/Shell";

const Bench = lazy(() => import("./pages/bench/BenchPage"));
const Registers = lazy(() => import("./pages/registers/RegistersPage"));
const Ramps = lazy(() => import("./pages/ramps/RampsPage"));
const Microsteps = lazy(() => import("./pages/microsteps/MicrostepsPage"));
const Chain = lazy(() => import("./pages/chain/ChainPage"));
const PlotSpeed = lazy(() => import("./pages/speed/PlotSpeedPage"));
const Connections = lazy(() => import("./pages/connections/ConnectionsPage"));

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
          <Route path="/" component={Bench} />
          <Route path="/registers" component={Registers} />
          <Route path="/ramps" component={Ramps} />
          <Route path="/microsteps" component={Microsteps} />
          <Route path="/chain" component={Chain} />
          <Route path="/connections" component={Connections} />
          <Route path="/bench/plots" component={PlotSpeed} />
          <Route>
            <Redirect to="/" replace />
          </Route>
        </Switch>
      </Suspense>
    </Shell>
  );
}
