import { Tabs as TabStrip } from "@mantine/core";
import type { CSSProperties } from "react";
import { type LayoutDocument, MOTION, type Part, partsOf, type Size, shownOf, signOf, type Tabs } from "./document";
import { titleOf, typeOf } from "./panels";
import { Slot } from "./Slot";
import css from "./workspace.module.css";

interface Props {
  document: LayoutDocument;
  part: Part;
  onShow: (id: string) => void;
}

/** A layout as it stands, without anything to arrange it with: what is there at first, and what one works with. */
export function StaticDock({ document, part, onShow }: Props) {
  const root = "row" in part ? part : { row: [part] };
  return (
    <div className={css.root} data-part={signOf(root)}>
      {root.row.map((each) => (
        <Box key={signOf(each)} document={document} part={each} onShow={onShow} />
      ))}
    </div>
  );
}

const FLEX: Readonly<Record<string, string>> = { content: "0 0 auto", shrinking: "0 1 auto" };

function flexOf(size: Size | undefined, shrinks: boolean): string {
  if (typeof size === "number") return `${size} 1 0`;
  return size === undefined ? "1 1 0" : (FLEX[shrinks ? "shrinking" : size] ?? `0 0 ${size}`);
}

function Box({ document, part, onShow }: Props) {
  const sign = signOf(part);
  const types = sign.split(",").map((id) => document.panels[id]?.type ?? "");
  const moves = types.includes(MOTION);
  const known = "tabs" in part ? typeOf(document.panels[shownOf(part)]?.type) : undefined;
  const style = {
    "--flex": flexOf(part.size, part.size === "content" && known?.fills === true),
    ...(part.size !== "content" && known && { "--least": `${known.min[1]}px` }),
  } as CSSProperties;
  const shape = "tabs" in part ? "tabs" : "row" in part ? "row" : "col";
  return (
    <div className={css.part} data-shape={shape} data-part={sign} data-moves={moves} style={style}>
      {"tabs" in part ? (
        <TabBox document={document} part={part} onShow={onShow} />
      ) : (
        partsOf(part).map((each) => <Box key={signOf(each)} document={document} part={each} onShow={onShow} />)
      )}
    </div>
  );
}

function TabBox({ document, part, onShow }: { document: LayoutDocument; part: Tabs; onShow: Props["onShow"] }) {
  const shown = shownOf(part);
  if (part.tabs.length < 2) return shown === "" ? null : <Slot key={shown} id={shown} />;
  return (
    <TabStrip
      value={shown}
      onChange={(id) => id !== null && onShow(id)}
      keepMounted={false}
      classNames={{ root: css.tabs ?? "", tab: "pad-s text-12", panel: css.panel ?? "" }}
    >
      <TabStrip.List>
        {part.tabs.map((id) => (
          <TabStrip.Tab key={id} value={id}>
            {titleOf(document, id)}
          </TabStrip.Tab>
        ))}
      </TabStrip.List>
      {part.tabs.map((id) => (
        <TabStrip.Panel key={id} value={id}>
          <Slot id={id} />
        </TabStrip.Panel>
      ))}
    </TabStrip>
  );
}
