import "@mantine/core/styles.layer.css";
import "uplot/dist/uPlot.min.css";
import "./tokens.css";
import "./lib/ui.css";
import "./app.css";
import { MantineProvider } from "@mantine/core";
import { QueryClient, QueryClientProvider } from "@tanstack/react-query";
import { StrictMode } from "react";
import { createRoot } from "react-dom/client";
import { App } from "./App";
import { askAccess } from "./api/access";
import { watchLease } from "./api/lease/bench";
import { inter } from "./font";
import { followDensity } from "./lib/look";
import { conditions } from "./live/conditions";
import { RootBoundary } from "./shell/RootBoundary";
import { Toasts } from "./shell/Toasts";
import { theme } from "./theme";

const queries = new QueryClient({
  // A bench is local: a failed call is shown at once instead of being tried again behind the user's back.
  defaultOptions: {
    queries: { retry: false, staleTime: 1000, refetchOnWindowFocus: true },
    mutations: { retry: false },
  },
});

followDensity(document.documentElement);
void askAccess();
watchLease();
conditions.start();
const root = document.getElementById("root");
if (!root) throw new Error("index.html has no #root");
createRoot(root).render(
  <StrictMode>
    <MantineProvider theme={theme} defaultColorScheme="auto">
      <QueryClientProvider client={queries}>
        <Toasts />
        <RootBoundary>
          <App />
        </RootBoundary>
      </QueryClientProvider>
    </MantineProvider>
  </StrictMode>,
);
void inter();
