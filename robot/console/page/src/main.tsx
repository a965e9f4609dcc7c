import { render } from 'preact'

import { ActionBar } from './action_bar'
import { ConfirmView } from './confirm_view'
import { ImageView } from './image_view'
import { connect } from './link'
import { PlanPanel } from './plan_panel'
import { Plots } from './plots'
import { StepRail } from './step_rail'
import { AlarmLine, TopBar } from './top_bar'

render(
  <div class="page">
    <TopBar />
    <AlarmLine />
    <StepRail />
    <ImageView>
      <ConfirmView />
    </ImageView>
    <PlanPanel>
      <Plots />
    </PlanPanel>
    <ActionBar />
  </div>,
  document.getElementById('page')!,
)
connect()
