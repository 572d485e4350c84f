import { Component, type PropsWithChildren } from "react";
import { stopEverything } from "./stopEverything";

const onKey = (event: KeyboardEvent) => {
  if (event.key === "Escape" && !event.repeat) void stopEverything();
};

/** The last boundary: where the shell itself has failed there is still a stop, and no white page. Nothing of the library. */
export class RootBoundary extends Component<PropsWithChildren, { error: Error | null }> {
  override state: { error: Error | null } = { error: null };

  static getDerivedStateFromError(error: Error) {
    return { error };
  }

  override componentDidUpdate() {
    if (this.state.error !== null) window.addEventListener("keydown", onKey);
  }

  override render() {
    const { error } = this.state;
    if (error === null) return this.props.children;
    return (
      <main role="alert" style={{ padding: 24 }}>
        <h1>stepscope's page has failed</h1>
        <p>Motors go on as they were. Stop them here or with Escape, then load the page anew.</p>
        <p>
          <button type="button" data-testid="stop-all" onClick={() => void stopEverything()}>
            STOP ALL
          </button>{" "}
          <button type="button" onClick={() => window.location.reload()}>
            Reload the page
          </button>
        </p>
        <pre>{error.message}</pre>
      </main>
    );
  }
}
