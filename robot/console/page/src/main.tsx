import { render } from 'preact'

import { ActionBar } from './action_bar'
import { AlarmLine, AlarmList } from './alarms/alarm_line'
import { preventGestures } from './browser_gestures'
import { ConfirmView } from './confirm_view'
import { connect } from './link'
import { LossScreen } from './loss_screen'
import { PlanPanel } from './plan_panel'
import { Plots } from './plots'
import { StepRail } from './step_rail'
import { TopBar } from './top_bar'
import { ImageView } from './viewer/image_view'

render(
  <div class="page">
    <TopBar />
    <AlarmLine />
    <StepRail />
    <ImageView>
      <ConfirmView />
      <LossScreen />
    </ImageView>
    <PlanPanel>
      <Plots />
    </PlanPanel>
    <AlarmList />
    <ActionBar />
  </div>,
  document.getElementById('page')!,
)
preventGestures()
connect()
