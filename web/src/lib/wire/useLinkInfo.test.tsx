// @vitest-environment jsdom
import { QueryClient, QueryClientProvider } from "@tanstack/react-query";
import { act } from "react";
import { createRoot } from "react-dom/client";
import { expect, it, vi } from "vitest";
import { api } from "../../api/client";
import type { Device } from "../../api/queries";
import { useLinkInfo } from "./useLinkInfo";

const one = { id: "one", state: "connected" } as Device;

it.each([
  [[one], 1],
  [[], 0],
])("with the devices %j the wire of the one is asked for %i times", async (listed, times) => {
  globalThis.IS_REACT_ACT_ENVIRONMENT = true;
  const asked = vi
    .spyOn(api, "GET")
    .mockClear()
    .mockResolvedValue({} as never);
  const client = new QueryClient();
  client.setQueryData(["devices"], listed);
  const Shown = () => String(useLinkInfo(one).data);
  const page = (
    <QueryClientProvider client={client}>
      <Shown />
    </QueryClientProvider>
  );
  const root = createRoot(document.createElement("div"));
  await act(async () => root.render(page));
  await vi.waitFor(() => expect(client.getQueryState(["link", "one"])?.status).toBe("success"));
  expect(asked).toHaveBeenCalledTimes(times);
  await act(async () => root.unmount());
});
