import "flexlayout-react/style/light.css";
import {
  type Action,
  Actions,
  DockLocation,
  type DropInfo,
  type ITabSetRenderValues,
  Layout,
  Model,
  type Node,
  TabNode,
  TabSetNode,
} from "flexlayout-react";
import { useCallback, useLayoutEffect, useMemo, useRef, useState } from "react";
import css from "./dock.module.css";
import { type LayoutDocument, MOTION, type Part } from "./document";
import { arranged } from "./edits";
import { type FlexNode, fromFlex, type Given, SPLITTER_PX, same, toFlex } from "./flex";
import { MEASURED } from "./measured";
import { PanelMenu, type Side } from "./PanelMenu";
import { titleOf, typeOf } from "./panels";
import { Slot } from "./Slot";

interface Props {
  document: LayoutDocument;
  put: (document: LayoutDocument, said: string) => void;
}

const AT: Readonly<Record<Side, DockLocation>> = {
  left: DockLocation.LEFT,
  right: DockLocation.RIGHT,
  above: DockLocation.TOP,
  below: DockLocation.BOTTOM,
  into: DockLocation.CENTER,
};

const GLOBAL = {
  tabEnableClose: false,
  tabEnableRename: false,
  tabEnablePopout: false,
  tabSetEnableMaximize: false,
  tabSetEnableDivide: true,
  splitterSize: SPLITTER_PX,
};

interface Drawn {
  model: Model;
  given: Given;
  desktop: Part;
}

/** The layout to be arranged: tabs to drag, splitters, a menu for each panel. The only file that knows the library. */
export function Dock({ document, put }: Props) {
  const box = useRef<HTMLDivElement>(null);
  const [drawn, setDrawn] = useState<Drawn | null>(null);
  const now = useRef({ document, put, given: new Map() as Given });
  now.current.document = document;
  now.current.put = put;
  const { desktop } = document.screens;

  // what was changed elsewhere, by the menu of layouts say, is drawn anew; what was changed here is drawn already
  useLayoutEffect(() => {
    const size = box.current?.getBoundingClientRect();
    if (!size || (drawn !== null && same(drawn.desktop, desktop))) return;
    const { document: shown } = now.current;
    const { row, given } = toFlex(
      shown,
      { width: size.width, height: size.height },
      (sign) => MEASURED.get(sign),
      (id) => ({ name: titleOf(shown, id), min: typeOf(shown.panels[id]?.type)?.min ?? [160, 80] }),
    );
    const model = Model.fromJson({ global: GLOBAL, layout: row });
    model.setOnAllowDrop((dragged, drop) => mayDrop(now.current.document, dragged, drop));
    setDrawn({ model, given, desktop });
  }, [desktop, drawn]);

  const changed = useCallback((model: Model, action: Action) => {
    setDrawn((before) => {
      if (before === null) return before;
      const given = new Map(before.given);
      const resized = action.type === Actions.ADJUST_WEIGHTS;
      const next = fromFlex(model.toJson().layout as FlexNode, before.given, resized, given);
      return next === null || same(next, before.desktop) ? before : { ...before, given, desktop: next };
    });
    said.current = wordsFor(now.current.document, action);
  }, []);
  const said = useRef("");
  const drawnDesktop = drawn?.desktop;
  useLayoutEffect(() => {
    const { document: known, put: tell } = now.current;
    if (drawnDesktop && said.current !== "" && !same(drawnDesktop, known.screens.desktop))
      tell(arranged(known, drawnDesktop), said.current);
    said.current = "";
  }, [drawnDesktop]);

  const model = drawn?.model;
  const onRenderTabSet = useMemo(
    () => (node: unknown, values: ITabSetRenderValues) => {
      if (!(node instanceof TabSetNode)) return;
      const shown = node.getSelectedNode();
      if (!(shown instanceof TabNode) || !model) return;
      values.buttons.push(
        <PanelMenu
          key="menu"
          id={shown.getId()}
          move={(side, other) => {
            const target = model.getNodeById(other)?.getParent();
            if (target) model.doAction(Actions.moveNode(shown.getId(), target.getId(), AT[side], -1, true));
          }}
        />,
      );
    },
    [model],
  );

  return (
    <div ref={box} className={css.dock} data-testid="dock">
      {model && (
        <Layout
          model={model}
          factory={(node) => <Slot id={node.getId()} />}
          onModelChange={changed}
          onRenderTabSet={onRenderTabSet}
          realtimeResize={false}
          supportsPopout={false}
        />
      )}
    </div>
  );
}

/** What moves the motor is never behind another panel, and none is behind it. */
function mayDrop(document: LayoutDocument, dragged: Node, { node, location }: DropInfo): boolean {
  if (location !== DockLocation.CENTER) return true;
  const ids = [dragged, node].flatMap((each) => [each, ...each.getChildren()]).map((each) => each.getId());
  return !ids.some((id) => document.panels[id]?.type === MOTION);
}

function wordsFor(document: LayoutDocument, { type, data }: Action): string {
  const id = String(data?.fromNode ?? data?.tabNode ?? data?.node ?? "");
  const what = Object.hasOwn(document.panels, id) ? titleOf(document, id) : "The panels";
  if (type === Actions.MOVE_NODE) return `${what} moved`;
  if (type === Actions.SELECT_TAB) return `${what} is shown`;
  return type === Actions.ADJUST_WEIGHTS ? "Sizes changed" : `${what} changed`;
}
