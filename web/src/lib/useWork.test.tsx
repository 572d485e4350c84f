// @vitest-environment jsdom
import { QueryClient, QueryClientProvider, useMutation } from "@tanstack/react-query";
import { act, useLayoutEffect } from "react";
import { flushSync } from "react-dom";
import { createRoot } from "react-dom/client";
import { describe, expect, it } from "vitest";
import { useWork } from "./useWork";

type Press = (work: () => Promise<void>) => { mutate: () => void };

/** What is sent where the button is pressed while the page shows 1, and 2 right afterwards. */
async function sent(usePress: Press): Promise<number[]> {
  globalThis.IS_REACT_ACT_ENVIRONMENT = true;
  const came: number[] = [];
  function Design({ shown }: { shown: number }) {
    const press = usePress(async () => {
      came.push(shown);
    });
    // biome-ignore lint/correctness/useExhaustiveDependencies: once, as a finger does
    useLayoutEffect(() => {
      if (shown === 1) press.mutate();
    }, [shown]);
    return null;
  }
  const root = createRoot(document.createElement("div"));
  const client = new QueryClient();
  const page = (shown: number) => (
    <QueryClientProvider client={client}>
      <Design shown={shown} />
    </QueryClientProvider>
  );
  await act(async () => {
    flushSync(() => root.render(page(1)));
    flushSync(() => root.render(page(2)));
  });
  await act(async () => root.unmount());
  return came;
}

declare global {
  var IS_REACT_ACT_ENVIRONMENT: boolean;
}

describe("work of a button", () => {
  it("is that of what is shown when it is pressed", async () => {
    expect(await sent((work) => useWork(work))).toEqual([1]);
  });

  it("would be that of a later render with a bare mutation", async () => {
    const useBare: Press = (work) => {
      const mutation = useMutation({ mutationFn: work });
      return { mutate: () => mutation.mutate() };
    };
    expect(await sent(useBare)).toEqual([2]);
  });
});
